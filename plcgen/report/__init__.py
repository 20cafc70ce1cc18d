"""Results as text: ``registry`` knows the formats, ``formats`` holds one file for each; pure, no I/O, no clock."""

"""Jobs that read back what they have written."""

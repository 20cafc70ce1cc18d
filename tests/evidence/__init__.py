"""What genuine files say, measured on a folder of exports and sources, kept as counts: ``python -m tests.evidence``."""

"""What genuine files say, measured on a folder of exports and sources and kept as counts: ``python -m evidence``."""

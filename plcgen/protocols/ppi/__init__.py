"""PPI: jobs on S7-200 stations over a serial line."""

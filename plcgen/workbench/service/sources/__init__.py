"""PLC sources: what is wrong, what a name is and where it lies, who uses it, how it looks."""

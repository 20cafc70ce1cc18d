"""Everything from outside as text: bounded files, YAML with positions; every failure a diagnostic at its place."""

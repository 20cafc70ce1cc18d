"""Two versions of a project compared: their specs, their blocks, and a lock."""

"""Semantic comparison of two sets of PLC sources or specs, and the lock file that holds one side of it."""

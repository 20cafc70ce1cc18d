"""Spec to the frozen plan of PPI masters."""

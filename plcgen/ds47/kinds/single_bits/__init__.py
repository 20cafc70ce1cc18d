"""Bits of words that a job reads, each an output of its own."""

"""What is wrong with planned PPI masters."""

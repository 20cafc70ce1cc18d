"""What is wrong with planned parameter jobs."""

"""Jobs that write old values back if they fail."""

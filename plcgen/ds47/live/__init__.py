"""Real drives and CPUs: over the S7 protocol, where nothing here can write, and drives over PROFINET's records."""

"""Reading from real drives and CPUs over the S7 protocol, and comparing: nothing here can write."""

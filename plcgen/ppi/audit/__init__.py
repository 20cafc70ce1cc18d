"""Hand-written PPI telegrams, and the calls that send and receive them, against the frame and a spec."""

"""Hand-written request and response DBs, and the calls that send them, against a spec and data set 47."""

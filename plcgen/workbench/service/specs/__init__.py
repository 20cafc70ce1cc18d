"""Specs: what is wrong, what may stand at a place, what is known of it, where it is named."""

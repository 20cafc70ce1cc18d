"""A recorded run as text, JSON and VCD."""

"""Reads without a type: the answer says what the value is, and outputs of their own show it."""

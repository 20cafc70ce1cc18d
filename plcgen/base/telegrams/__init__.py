"""Telegrams of any protocol taken apart: bytes by field, as a table and as data."""

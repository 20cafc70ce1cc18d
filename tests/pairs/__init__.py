"""Specs by combination: every pair of values of every two dimensions occurs in one of them."""

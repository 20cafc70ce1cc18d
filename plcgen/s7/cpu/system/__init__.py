"""System blocks and functions of the soft CPU."""

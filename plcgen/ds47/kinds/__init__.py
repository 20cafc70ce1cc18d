"""The kinds of drive jobs, one module each: its settings, and which accesses to parameters they mean."""

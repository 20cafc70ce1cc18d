"""The catalogue looked at from outside: what is known of a parameter and how, and what lists of a drive say besides."""

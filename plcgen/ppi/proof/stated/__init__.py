"""Generated PPI masters against the statement of their spec (``oracles.spec.ppi``)."""

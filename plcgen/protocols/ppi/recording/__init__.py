"""Jobs of PPI masters in recorded runs: see ``plcgen.trace.face``."""

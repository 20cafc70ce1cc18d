"""Drive jobs in recorded runs: see ``plcgen.trace.face``."""

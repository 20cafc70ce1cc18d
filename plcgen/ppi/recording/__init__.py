"""Jobs of PPI masters in recorded runs: see ``plcgen.report.trace.face``."""

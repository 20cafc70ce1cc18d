"""Drive jobs in recorded runs: see ``plcgen.report.trace.face``."""

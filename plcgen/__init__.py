"""plcgen."""

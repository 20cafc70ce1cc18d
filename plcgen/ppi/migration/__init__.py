"""Programs of an S7-200 on their way to an S7-1200: symbols and V memory."""

"""``plcgen lsp``: the service as a language server."""

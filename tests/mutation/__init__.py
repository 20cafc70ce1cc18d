"""Mutation of the generated SCL: how much damage does verify notice? Development only, not part of the package."""

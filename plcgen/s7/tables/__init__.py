"""Memory layouts of specs and sources as tables, pictures and pages."""

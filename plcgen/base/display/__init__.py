"""What people and programs are shown, before any format: cells, tables, pages, excerpts; pure, no I/O."""

"""What everything stands on: diagnostics, files, bounds, tables and pages as data, lines, resources."""

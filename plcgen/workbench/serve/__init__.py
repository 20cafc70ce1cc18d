"""The page of the workbench: a server on this machine alone, over the same functions as the command line."""

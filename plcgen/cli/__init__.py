"""The command line: ``main`` finds the verbs, ``output`` owns the streams and exit codes, one module per verb."""

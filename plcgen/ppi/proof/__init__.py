"""PPI masters under test: rig, runner and scenarios."""

"""Drive jobs under test: rig, runner and scenarios."""

"""Drive jobs under test, with the plan: rig, runner and scenarios. What is held against the spec is in ``stated``."""

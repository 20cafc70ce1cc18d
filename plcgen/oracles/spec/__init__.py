"""What a spec demands, read a second time: from its YAML, the pages of the documentation and public documents alone.

Nothing here imports anything of plcgen outside ``plcgen.oracles``: what planner, kinds, views and wire agree on without
being right stops here. The caller hands in plain mappings and where their values stand.
"""

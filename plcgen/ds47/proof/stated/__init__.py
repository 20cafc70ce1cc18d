"""The files on disk against what the spec demands: they run from OB1 with a device that only records and answers.

What is expected comes from ``plcgen.oracles.spec`` alone. Nothing here looks at a plan, and names of members are those
that docs/generated-code.md and docs/spec.md give them.
"""

"""What drive jobs of a spec demand: docs/spec.md, docs/generated-code.md, docs/devices.md, docs/hardware-id.md, and
the PROFIdrive profile as the manuals named in :mod:`plcgen.oracles.profidrive` print it.
"""

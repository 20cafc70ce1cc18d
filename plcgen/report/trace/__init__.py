"""A run of generated blocks in the soft CPU, recorded scan by scan.

``settings`` reads what goes wrong and what is set, ``program`` loads the files, ``recorder`` watches the CPU,
``run`` puts them together; ``model`` is what comes out.
"""

"""Results as text and as data: pure functions, no I/O, no clock.

``registry`` knows the formats, ``formats`` holds one file for each of them. What they are made of: ``cells``, ``paint``
and ``table`` for a terminal, ``excerpts`` for diagnostics, ``data`` for programs, ``view`` for how a result shall look.
"""

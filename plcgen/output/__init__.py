"""Results as text and as data: one small pure module per output format, no I/O, no clock.

``text`` is for people, ``json``, ``sarif``, ``junit`` and ``github`` are for programs; ``layout``, ``telegram``
and ``page`` show memory layouts, telegrams and explanations. ``cells`` and ``paint`` know the terminal.
"""

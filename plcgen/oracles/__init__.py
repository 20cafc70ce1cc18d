"""Second opinions: what documents alone say about telegrams, apart from everything else here.

Nothing in this room imports anything of plcgen, and the generator imports nothing of this room: a belief that
generator and verifier share stops at its door. ``profidrive`` is a drive written from the manuals that its docstring
names; ``offsets`` a reader and calculator of layouts; ``wireshark`` asks the dissector of the Wireshark project.
"""

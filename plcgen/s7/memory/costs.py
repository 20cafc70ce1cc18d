"""Lengths in bytes of what the SCL compiler of the S7-300/400 makes, as README.md has them."""

from __future__ import annotations

HEADER = 36
"""Header of every block in the work memory."""

ACCESS = 4
NEAR = 2
OPEN_NEAR = 2
OPEN = 4
NEAR_DB = 256
POINTED_IN_FC = 28
POINTED_IN_FB = 44
FIRST_BIT = 2
"""CLR before the first bit of a condition."""
CONSTANTS = {1: 2, 8: 2, 16: 4, 32: 6}
"""Loading a constant, by its width in bits."""

OPERATION = 2
SWAP = 2
SPILL = 10
"""Keeping the left operand while a right one is worked out that needs the accumulators itself."""
TERM = 8
"""A term of a condition that is no plain AND of a variable: kept in a temporary bit and joined."""

WIDEN_INDEX = 2
LOW_BOUND = 8
SCALE = 8
NEXT_INDEX = 2
OFFSET = 8
IN_INSTANCE = 4
TO_REGISTER = 2
KEEP_WHILE_INDEXING = 14
BY_DB_NUMBER = 26

JUMP = 4
SELECTOR = 4
LABEL = 12
RANGE = 28
BRANCH = 8
FOR_ROUND = 28
OK_FLAG = 18
COPY = 84

CALL = 8
SAVE_REGISTERS = 8
POINTER = 4
STRUCTURE = 18
ANY = 28
INSTANCE_CALL = 26
MULTI_INSTANCE_CALL = 12
FROM_OTHER_INSTANCE = 8
IN_OUT = 8

SHIFT_BY_VARIABLE = 34
CHOICE = 8
TO_REAL = 4
NARROW = 6
NARROW_DOUBLE = 8
BIT_CONVERSION = 16

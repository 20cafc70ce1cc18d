"""Siemens' own PROFIdrive parameter manager, compiled where its source is, as a drive that answers WRREC and RDREC.

``PLCGEN_PROFIDRIVE`` names the folder of ``pdrv_parmanager_ac4.c``: the PROFIdrive application example (AC4, profile
V4.2) of the development kits for ERTEC. It is Siemens' and no part of this project; a compiler is needed as well.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from plcgen.ds47.wire.formats import Format

HERE = Path(__file__).parent / "reference_drive"
SOURCE = "pdrv_parmanager_ac4.c"
READ_ONLY, ARRAY = 0x0200, 0x4000
"""Bits of an identifier (profile V4.2, table 18)."""
ANSWERS = 240


def build(folder: Path) -> ctypes.CDLL:
    """Compile the manager with a database of our own; skips where source or compiler is missing."""
    source = Path(os.environ.get("PLCGEN_PROFIDRIVE", "")) / SOURCE
    compiler = shutil.which("cc")
    if not os.environ.get("PLCGEN_PROFIDRIVE") or not source.is_file():
        pytest.skip(f"PLCGEN_PROFIDRIVE is not the folder of {SOURCE}")
    if compiler is None:
        pytest.skip("there is no C compiler")
    library = folder / "reference.so"
    command = [compiler, "-shared", "-fPIC", "-O1", f"-I{HERE}", f"-I{source.parent}", "-o", str(library)]
    subprocess.run([*command, str(HERE / "database.c"), str(source)], check=True)
    return ctypes.CDLL(str(library))


class ReferenceDrive:
    """One controller's connection to it; ``wire`` keeps requests and answers."""

    def __init__(self, library: ctypes.CDLL) -> None:
        self.library = library
        self.wire: list[tuple[bytes, bytes]] = []
        self.asked = b""
        library.reference_reset()

    def define(
        self, pnu: int, fmt: Format, elements: int = 0, low: int = 0, high: int = 0xFFFFFFFF, *, fixed: bool = False
    ) -> None:
        """Add a parameter; limits are the bits of a value, with ``elements`` it is an array or a string."""
        identifier = fmt.code | (READ_ONLY if fixed else 0) | (ARRAY if elements and not fmt.is_string else 0)
        assert self.library.reference_define(pnu, identifier, elements, fmt.size, low, high)

    def write_record(self, index: int, data: bytes) -> int:
        """Take a request; DF80xx00 with the error code of the manager."""
        assert index in {47, 0xB02E, 0xB02F}
        length = ctypes.c_uint32(len(data))
        code = self.library.uPdrvPar_WriteReqCxn(1, ctypes.byref(length), (ctypes.c_uint8 * len(data))(*data))
        self.asked = data
        return 0xDF800000 | code << 8 if code else 0

    def read_record(self, index: int, max_length: int) -> tuple[int, bytes]:
        """Hand out the answer; DE80xx00 if there is none."""
        assert index in {47, 0xB02E, 0xB02F}
        length, buffer = ctypes.c_uint32(max_length), (ctypes.c_uint8 * max(max_length, ANSWERS))()
        code = self.library.uPdrvPar_ReadReqCxn(1, ctypes.byref(length), buffer)
        if code:
            return 0xDE800000 | code << 8, b""
        self.wire.append((self.asked, bytes(buffer[: length.value])))
        return 0, self.wire[-1][1]

    def advance(self, _milliseconds: int, /) -> None:
        """Its main loop goes round once."""
        self.library.PdrvPar_ProcessReq()

    def answer(self, request: bytes) -> bytes:
        """What it answers to one request."""
        assert self.write_record(47, request) == 0
        self.advance(0)
        return self.read_record(47, ANSWERS)[1]

"""How a single file is written: it is the old one or the new one, never half of either."""

from __future__ import annotations

import errno
import os
import secrets
import stat
from pathlib import Path


def replace_file(path: Path, data: bytes) -> None:
    """Write beside the file and rename: whatever goes wrong on the way, the old file is still there.

    A link stays, its target is replaced. A device, FIFO or socket is written to. An old file keeps its mode,
    and one that may not be written is not replaced either.

    Raises:
        OSError: if that is not possible; nothing has changed then.
    """
    target = path.resolve()
    mode = target.stat().st_mode if target.exists() else None
    if mode is not None and not stat.S_ISREG(mode):
        target.write_bytes(data)
        return
    if mode is not None and not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(target))
    draft = target.with_name(f".plcgen-draft-{secrets.token_hex(8)}")
    try:
        with draft.open("xb") as out:
            out.write(data)
        if mode is not None:
            draft.chmod(mode)
        draft.replace(target)
    except BaseException:
        draft.unlink(missing_ok=True)
        raise

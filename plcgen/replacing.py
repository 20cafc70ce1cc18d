"""How a single file is written: it is the old one or the new one, never half of either."""

from __future__ import annotations

import secrets
import stat
from pathlib import Path


def replace_file(path: Path, data: bytes) -> None:
    """Write beside the file and rename: whatever goes wrong on the way, the old file is still there.

    A link stays, its target is replaced. A device, FIFO or socket is written to. An old file keeps its mode.

    Raises:
        OSError: if that is not possible; nothing has changed then.
    """
    target = path.resolve()
    mode = target.stat().st_mode if target.exists() else None
    if mode is not None and not stat.S_ISREG(mode):
        target.write_bytes(data)
        return
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

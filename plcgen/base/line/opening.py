"""Open a line by its name."""

from __future__ import annotations

import os
import re

from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.base.line.model import CANNOT_OPEN, Line, LineError
from plcgen.base.line.tcp import SCHEME

RFC2217 = "rfc2217://"
SCHEMES = {
    SCHEME: "raw TCP, as most serial servers carry it",
    RFC2217: "a serial server that takes speed and parity from its client",
}
"""Kinds of lines that have a scheme, and what they are."""
_OTHERS = {"tcp://": SCHEME, "raw://": SCHEME, "telnet://": RFC2217} | dict.fromkeys(
    ("serial://", "com://", "tty://", "file://"), ""
)
"""What people write, and what they mean: a scheme, or none for a port."""
_ENDPOINT = re.compile(r"[^/\s]*:\d+")
"""A host with a port and no scheme, as people call a serial server."""


def open_line(name: str, rate: int = 9600) -> Line:
    """Open ``socket://HOST:PORT``, ``rfc2217://HOST:PORT`` or, without a scheme, a serial port.

    ``rate`` in bit/s counts for serial ports and RFC 2217 only. Raises LineError.
    """
    scheme = name[: name.find("://") + 3].lower() if "://" in name else ""
    if scheme == SCHEME and not name.rstrip("/").endswith(":102"):
        from plcgen.base.line.tcp import TcpLine

        return TcpLine.connect(SCHEME + name[len(SCHEME) :])
    if scheme not in {"", RFC2217}:
        what = "a serial server has another port" if scheme == SCHEME else f'unknown kind of line "{scheme}"'
        raise LineError(CANNOT_OPEN, name, what, _hint(name, scheme))
    if not scheme and _ENDPOINT.fullmatch(name) and not os.path.lexists(name):
        host, _, _ = name.partition(":")
        serial = re.fullmatch(r"(?i)com[0-9]+|tty.*", host) is not None
        help_ = _hint(name, "") if name.endswith(":102") else f'did you mean "{SCHEME}{name}"?'
        help_ = f"write {host}: the speed is an option of its own" if serial else help_
        raise LineError(CANNOT_OPEN, name, "a port has no colon and no number after it", help_)
    from plcgen.base.line.serial import SerialLine

    return SerialLine(name, rate)


def _hint(name: str, scheme: str) -> str:
    """What was meant, and what there is."""
    meant, rest = _OTHERS.get(scheme), name[len(scheme) :]
    if rest.rstrip("/").endswith(":102"):
        return f'port 102 is ISO-on-TCP, not PPI: did you mean "s7://{rest.rstrip("/").removesuffix(":102")}"?'
    guess = did_you_mean(scheme, SCHEMES) if meant is None else f'did you mean "{meant}{rest}"?'
    known = "; ".join(f"{each}HOST:PORT is {what}" for each, what in SCHEMES.items())
    return f"{guess} {known}; a port has no scheme".strip()

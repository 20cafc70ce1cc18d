"""python-snap7's own server as a drive and as a CPU: the other side of the connection, written by others."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Iterator

from snap7.server import Server
from snap7.type import SrvArea

READ, WRITE = 0x00020000, 0x00040000


class DriveServer(Server):
    """Elements by data block and address; their areas overlap, which no flat memory can show."""

    def __init__(self, elements: dict[tuple[int, int], bytes]) -> None:
        super().__init__(log=False)
        self.elements = elements
        self.asked: list[tuple[int, int, int]] = []

    def _read_from_memory_area(self, _area, db_number, start, count):
        self.asked.append((db_number, start, count))
        data = self.elements.get((db_number, start), b"")
        return (0xFF, bytearray(data)) if len(data) == count else (0x0A, bytearray())


def free_port() -> int:
    """A port that nobody uses."""
    with socket.create_server(("127.0.0.1", 0)) as probe:
        return probe.getsockname()[1]


@contextlib.contextmanager
def running(server: Server) -> Iterator[str]:
    """The server on a port of this machine, and its address."""
    port = free_port()
    server.start_to("127.0.0.1", port)
    try:
        yield f"127.0.0.1:{port}"
    finally:
        server.stop()


def cpu(blocks: dict[int, bytes]) -> Server:
    """A CPU with data blocks."""
    server = Server(log=False)
    for number, data in blocks.items():
        server.register_area(SrvArea.DB, number, bytearray(data))
    return server

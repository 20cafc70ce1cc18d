"""As much of an MQTT 3.1.1 broker as the tests of the log need, written from the OASIS standard of 2014-10-29."""

import socket
import threading
from queue import SimpleQueue


class Broker:
    """Takes connections one after the other; ``messages`` gets (topic, payload, retain), the will included."""

    def __init__(self, port=0, code=0):
        self.messages, self.greetings, self.retained = SimpleQueue(), SimpleQueue(), {}
        self._code, self._line = code, None
        self._server = socket.create_server(("127.0.0.1", port))
        self.port = self._server.getsockname()[1]
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def cut(self):
        """End the connection without a word; the will is published."""
        self._line.shutdown(socket.SHUT_RDWR)

    def close(self):
        """End everything."""
        self._server.shutdown(socket.SHUT_RDWR)
        if self._line:
            self._line.close()
        self._server.close()
        self._thread.join(10)

    def _serve(self):
        while True:
            try:
                self._line, _ = self._server.accept()
            except OSError:
                return
            self._will = None
            with self._line, self._line.makefile("rb") as stream:
                try:
                    while self._packet(stream):
                        pass
                except OSError:
                    pass
            if self._will:
                self._keep(*self._will)

    def _packet(self, stream):
        """One packet (section 2.2: type and flags, remaining length in groups of 7 bits); False at the end."""
        head = stream.read(1)
        if not head:
            return False
        length = shift = 0
        while (byte := stream.read(1)[0]) & 0x80:
            length, shift = length | (byte & 0x7F) << shift, shift + 7
        body = stream.read(length | byte << shift)
        kind, flags = head[0] >> 4, head[0] & 15
        if kind == 1:  # CONNECT, section 3.1: name, level, flags, keep alive, then the fields that the flags name
            rest, mark, fields = body[10:], body[7], []
            while rest:
                size = int.from_bytes(rest[:2], "big")
                fields, rest = [*fields, rest[2 : 2 + size]], rest[2 + size :]
            fields.pop(0)  # the client's name
            if mark & 0x04:
                self._will = fields.pop(0).decode(), fields.pop(0).decode(), bool(mark & 0x20)
            self.greetings.put([field.decode() for field in fields])
            self._line.sendall(bytes([0x20, 2, 0, self._code]))
        elif kind == 3:  # PUBLISH, section 3.3
            size = int.from_bytes(body[:2], "big")
            start = 4 + size if flags & 6 else 2 + size
            if flags & 6:
                self._line.sendall(b"\x40\x02" + body[2 + size : 4 + size])
            self._keep(body[2 : 2 + size].decode(), body[start:].decode(), bool(flags & 1))
        elif kind == 12:  # PINGREQ
            self._line.sendall(b"\xd0\x00")
        elif kind == 14:  # DISCONNECT: no will
            self._will = None
            return False
        return True

    def _keep(self, topic, payload, retain):
        if retain:
            self.retained[topic] = payload
        self.messages.put((topic, payload, retain))

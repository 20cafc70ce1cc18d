"""Values of a log for an MQTT broker: a retained message per change, through paho-mqtt (extra ``mqtt``), 3.1.1, QoS 1.

``TOPIC/STATION/ITEM`` has the last value as JSON, ``TOPIC/state`` is ``online`` or ``offline`` (the last will),
``TOPIC/lost`` says how many messages found no room while the broker was away. paho connects and sends in a thread of
its own, so no cycle waits for the broker; what that thread has to say waits in a queue for the next cycle.
"""

from __future__ import annotations

import json
import re
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from queue import Empty, SimpleQueue
from typing import Any
from urllib.parse import quote, urlsplit

from plcgen.base.diagnostics.counting import quantity
from plcgen.base.display.cells import clean
from plcgen.base.line.model import CANNOT_OPEN, MISSING_PACKAGE, LineError
from plcgen.ppi.client.texts import plain
from plcgen.ppi.client.values import Value
from plcgen.ppi.log.files import Channel, Row

MOST_WAITING = 10_000
"""Messages that wait for the broker; then the oldest give way."""
_HANDED = 1000
"""Messages that paho has and the broker has not acknowledged: these do not give way, so not all."""
_PATIENCE = 5.0
"""Seconds that the end waits for the broker."""
_PORTS = {"mqtt": 1883, "mqtts": 8883}
_FORM = "mqtt://[USER@]HOST[:PORT]/TOPIC, or mqtts:// with TLS"


@dataclass(frozen=True, slots=True)
class Target:
    """Where messages go; ``name`` is what people see."""

    host: str
    port: int
    topic: str
    user: str = ""
    tls: bool = False

    @property
    def name(self) -> str:
        """The address without the user."""
        return f"{'mqtts' if self.tls else 'mqtt'}://{self.host}:{self.port}/{self.topic}"

    @classmethod
    def of(cls, text: str) -> Target:
        """Read ``mqtt://user@host:1883/plant/press``. Raises LineError (PG720), which never repeats a password."""
        try:
            parts = urlsplit(text)
            port = parts.port or _PORTS[parts.scheme]
        except (KeyError, ValueError) as problem:
            raise LineError(CANNOT_OPEN, "--mqtt", "this is no address of a broker", _FORM) from problem
        if parts.password is not None:
            help_ = "leave it out here, and set PLCGEN_MQTT_PASSWORD: command lines are seen by other users"
            raise LineError(CANNOT_OPEN, "--mqtt", "a password does not belong into the address", help_)
        topic = parts.path.removeprefix("/")
        if not parts.hostname or parts.query or not re.fullmatch(r"[^\0-\x1f+#$/][^\0-\x1f+#]{0,199}", topic):
            raise LineError(CANNOT_OPEN, "--mqtt", "host or topic is missing, or is none", _FORM)
        if parts.fragment or "#" in text:
            raise LineError(CANNOT_OPEN, "--mqtt", "# is a wildcard: values need a topic of their own", _FORM)
        return cls(parts.hostname, port, topic.rstrip("/"), parts.username or "", parts.scheme == "mqtts")


class Publisher:
    """Takes every row of a logger and publishes what has changed in it.

    ``client`` is one of paho, not started; ``stamp`` writes times as the log does, ``tell`` gets what people at the
    terminal want to know.
    """

    def __init__(
        self,
        target: Target,
        channels: Sequence[Channel],
        client: Any,
        stamp: Callable[[float], str],
        tell: Callable[[str], None],
        most: int = MOST_WAITING,
    ) -> None:
        self._target, self._channels, self._client = target, channels, client
        self._stamp, self._tell, self._most = stamp, tell, most
        self._last: dict[int, Value | None] = {}
        self._waiting: deque[tuple[str, dict[str, Any]]] = deque()
        self._handed: set[int] = set()
        self._lost, self._lost_from = 0, ""
        self._events: SimpleQueue[tuple[str, Any]] = SimpleQueue()
        self._connections, self._up, self._trouble = 0, False, ""
        client.on_connect = self._connected
        client.on_connect_fail = lambda *_: self._events.put(("down", "it cannot be reached"))
        client.on_disconnect = lambda *_: self._events.put(("down", "the connection was lost"))
        client.on_publish = lambda _client, _data, number, *_: self._events.put(("sent", number))
        client.will_set(f"{target.topic}/state", "offline", qos=1, retain=True)
        client.connect_async(target.host, target.port)
        client.loop_start()

    def _connected(self, client: Any, _data: Any, _flags: Any, reason: Any, *_: Any) -> None:
        """In the thread of paho: the state first, as the will of the connection before may stand there."""
        if reason.is_failure:
            self._events.put(("down", f"it refuses: {reason}"))
            return
        client.publish(f"{self._target.topic}/state", "online", qos=1, retain=True)
        self._events.put(("up", None))

    def add(self, row: Row) -> None:
        """Publish the values of a row that have changed, or that the broker may have forgotten."""
        self._hear()
        for number, (channel, value) in enumerate(zip(self._channels, row.values, strict=True)):
            if number in self._last and not channel.differs(self._last[number], value):
                continue
            self._last[number] = value
            item = re.sub(r"^\s*[0-9]{1,3}:", "", channel.name)
            found = {
                "time": self._stamp(row.time),
                "station": channel.station,
                "item": clean(item),
                "value": plain(value),
                "quality": "bad" if value is None else "good",
            }
            if len(self._waiting) >= self._most:
                _, gone = self._waiting.popleft()
                self._lost, self._lost_from = self._lost + 1, self._lost_from or gone["time"]
            self._waiting.append((f"{channel.station}/{topic_level(item)}", found))
        self._hand_over()

    def _hear(self, timeout: float | None = None) -> None:
        """Take what the thread of paho has said; with a timeout in seconds, wait for the first of it."""
        try:
            while True:
                kind, found = self._events.get(timeout=timeout) if timeout else self._events.get_nowait()
                timeout = None
                self._heard(kind, found)
        except Empty:
            return

    def _heard(self, kind: str, found: Any) -> None:
        if kind == "sent":
            self._handed.discard(found)
        elif kind == "up":
            self._up, self._connections = True, self._connections + 1
            if self._trouble:
                self._tell(f"{self._target.name}: connected again")
            if self._connections > 1:
                self._last.clear()  # a broker that was started anew may have forgotten what it retained
            self._trouble = ""
        else:
            self._up = False
            if not self._trouble:
                self._tell(f"{self._target.name}: {found}; values wait in memory, the log goes on")
            self._trouble = found

    def _hand_over(self) -> None:
        """Give messages to paho as long as the broker is there and takes them; in front the mark of what was lost."""
        while self._up and len(self._handed) < _HANDED and (self._waiting or self._lost):
            if self._lost:
                mark: dict[str, Any] = {"from": self._lost_from, "messages": self._lost}
                if self._waiting:
                    mark["to"] = self._waiting[0][1]["time"]
                self._publish("lost", json.dumps(mark))
                self._lost, self._lost_from = 0, ""
            else:
                topic, found = self._waiting.popleft()
                self._publish(topic, json.dumps(found, ensure_ascii=False, allow_nan=False))

    def _publish(self, topic: str, text: str) -> None:
        self._handed.add(self._client.publish(f"{self._target.topic}/{topic}", text, qos=1, retain=True).mid)

    def close(self, now: Callable[[], float] = time.monotonic) -> bool:
        """Give the broker what waits, say ``offline``, end the connection; whether all of it was acknowledged."""
        self._hear()
        end = now() + _PATIENCE
        while not self._trouble and (self._waiting or self._handed or self._lost) and (left := end - now()) > 0:
            self._hand_over()
            self._hear(left)
        rest = len(self._waiting) + len(self._handed) + self._lost
        if rest:
            self._tell(f"{self._target.name}: {quantity(rest, 'message')} not acknowledged; the log has the values")
        if self._up:
            self._publish("state", "offline")
            while self._handed and (left := end - now()) > 0:
                self._hear(left)
        self._client.disconnect()
        self._client.loop_stop()
        return not rest


def topic_level(name: str) -> str:
    """A name as one level of a topic: what MQTT gives a meaning is written as in web addresses (``%2F``)."""
    return re.sub(r"[%/+#\0-\x1f\x7f]", lambda found: quote(found[0], safe=""), name)


def paho_client(target: Target, environment: Mapping[str, str]) -> Any:
    """A client of paho-mqtt, with the password of ``PLCGEN_MQTT_PASSWORD``. Raises LineError (PG723)."""
    try:
        from paho.mqtt.client import Client, MQTTv311
        from paho.mqtt.enums import CallbackAPIVersion
    except ImportError as problem:
        raise LineError(
            MISSING_PACKAGE, target.name, "MQTT needs the package paho-mqtt", 'pip install "plcgen[mqtt]"'
        ) from problem
    client = Client(CallbackAPIVersion.VERSION2, protocol=MQTTv311)
    client.reconnect_delay_set(1, 30)
    if target.user:
        client.username_pw_set(target.user, environment.get("PLCGEN_MQTT_PASSWORD"))
    if target.tls:
        client.tls_set()  # the authorities of the system, or of SSL_CERT_FILE
    return client

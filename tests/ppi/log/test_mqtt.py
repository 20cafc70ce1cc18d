"""plcgen ppi log --mqtt: what a broker gets, what waits while it is away, and that the file never suffers."""

import itertools
import json
import os
import subprocess
import sys
from datetime import UTC
from pathlib import Path
from types import SimpleNamespace

import pytest

from plcgen.base.line.tcp import TcpServer
from plcgen.cli.main import run
from plcgen.ppi.client.values import parse_place
from plcgen.ppi.log.files import Channel, Row, State, iso
from plcgen.ppi.log.mqtt import Publisher, Target, paho_client, topic_level
from plcgen.ppi.sim import Bus, Station
from plcgen.ppi.sim.serve import Serving
from tests.ppi.log.broker import Broker
from tests.ppi.log.support import MIDNIGHT, Day, iso_at, rows_of

ROOT = Path(__file__).parents[3]
TARGET = Target("broker", 1883, "plant/press")


class Fake:
    """A client that keeps what it is given and acknowledges when told to."""

    def __init__(self):
        self.sent, self.numbers, self.will, self.ended = [], itertools.count(1), None, False

    def publish(self, topic, text, *, qos, retain):
        """Take a message; the number is what the acknowledgement names."""
        assert (qos, retain) == (1, True)
        self.sent.append((topic.removeprefix("plant/press/"), text))
        self.number = next(self.numbers)
        return SimpleNamespace(mid=self.number)

    def will_set(self, topic, text, *, qos, retain):
        """Take the last will."""
        self.will = topic, text, qos, retain

    def connect_async(self, host, port):
        """Begin to connect."""

    def loop_start(self):
        """Begin the thread."""

    def disconnect(self):
        """End the connection."""

    def loop_stop(self):
        """End the thread."""
        self.ended = True

    def up(self):
        """The broker takes the connection."""
        self.on_connect(self, None, None, SimpleNamespace(is_failure=False))

    def acknowledge(self):
        """The broker has everything."""
        for number in range(1, self.number + 1):
            self.on_publish(self, None, number)

    def values(self):
        """Time, value and quality of the messages of values."""
        found = [json.loads(text) for topic, text in self.sent if topic not in {"state", "lost"}]
        return [(each["time"][17:19], each["value"], each["quality"]) for each in found]


def publisher(*words, most=100, told=None, deadband=0.0):
    """A publisher on a fake client."""
    channels = [Channel(2, parse_place(word), word, deadband) for word in words or ("VW100",)]
    fake = Fake()
    told = [] if told is None else told
    return Publisher(TARGET, channels, fake, lambda time: iso(time, UTC), told.append, most), fake


def row(second, *values):
    """A row of some second."""
    return Row(MIDNIGHT + second, State.BAD if None in values else State.GOOD, values)


def test_a_message_per_change():
    """Time, station, item, value, quality; the same value again is no message, neither is one within the deadband."""
    sink, fake = publisher("VW100", "M0.0", deadband=5)
    fake.up()
    for second, values in enumerate([(7, True), (7, True), (12, True), (13, True), (None, True), (13, False)]):
        sink.add(row(second, *values))
    assert fake.sent[:2] == [
        ("state", "online"),
        ("2/VW100", f'{{"time": "{iso_at(0)}", "station": 2, "item": "VW100", "value": 7, "quality": "good"}}'),
    ]
    # 7 to 12 is 5, not more; 13 is 6 from 7; without an answer the quality is bad
    assert fake.values() == [
        ("00", 7, "good"), ("00", True, "good"), ("03", 13, "good"), ("04", None, "bad"), ("05", 13, "good"),
        ("05", False, "good"),
    ]  # fmt: skip
    assert fake.will == ("plant/press/state", "offline", 1, True)


def test_nothing_is_lost_while_the_memory_lasts():
    """The broker comes in second 3: the values of seconds 0 to 2 arrive, in order and with their own times."""
    sink, fake = publisher()
    for second in range(3):
        sink.add(row(second, second))
    assert fake.sent == []
    fake.up()
    sink.add(row(3, 3))
    assert fake.values() == [(f"0{n}", n, "good") for n in range(4)]


def test_the_oldest_give_way_and_the_gap_is_marked():
    """Room for 3, values of seconds 0 to 9: 0 to 6 are lost, the mark stands in front of the rest and says so."""
    told = []
    sink, fake = publisher(most=3, told=told)
    fake.on_connect_fail(fake, None)
    for second in range(10):
        sink.add(row(second, second))
    fake.up()
    sink.add(row(10, 9))
    assert fake.sent[1] == ("lost", f'{{"from": "{iso_at(0)}", "messages": 7, "to": "{iso_at(7)}"}}')
    assert fake.values() == [("07", 7, "good"), ("08", 8, "good"), ("09", 9, "good")]
    assert told == [
        "mqtt://broker:1883/plant/press: it cannot be reached; values wait in memory, the log goes on",
        "mqtt://broker:1883/plant/press: connected again",
    ]


def test_a_broker_that_acknowledges_nothing_gets_a_bounded_number():
    """1500 changes without an acknowledgement: 1000 are with the client, the rest waits; all come with the answers."""
    sink, fake = publisher(most=2000)
    fake.up()
    for second in range(1500):
        sink.add(row(second, second))
    assert len(fake.values()) == 1000
    for _ in range(2):
        fake.acknowledge()
        sink.add(row(1500, 1499))
    assert [value for _, value, _ in fake.values()] == list(range(1500))


def test_after_a_reconnect_all_values_are_said_again():
    """The second connection may be to a broker that was started anew: it gets unchanged values, too."""
    sink, fake = publisher()
    fake.up()
    sink.add(row(0, 7))
    fake.on_disconnect(fake, None)
    fake.up()
    sink.add(row(1, 7))
    assert fake.values() == [("00", 7, "good"), ("01", 7, "good")]


def test_the_end_says_what_the_broker_has_not_acknowledged():
    """The broker refuses: one message is missing, nobody waits for it, the thread is ended."""
    told = []
    sink, fake = publisher(told=told)
    sink.add(row(0, 7))
    fake.on_connect(fake, None, None, Refusal())
    assert not sink.close()
    assert fake.ended
    assert told[0].endswith("it refuses: Not authorized; values wait in memory, the log goes on")
    assert told[1] == "mqtt://broker:1883/plant/press: 1 message not acknowledged; the log has the values"


def test_the_end_waits_for_a_connection_that_is_being_made():
    """A log of one read may end before the broker has answered: it comes while the end waits, and gets everything."""
    sink, fake = publisher()
    sink.add(row(0, 7))

    def now():
        if not fake.sent:
            fake.up()
        fake.acknowledge()
        return 0.0

    assert sink.close(now)
    assert fake.values() == [("00", 7, "good")]
    assert fake.sent[-1] == ("state", "offline")


class Refusal:
    """A reason code of paho."""

    is_failure = True

    def __str__(self):
        return "Not authorized"


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("mqtt://h/t", Target("h", 1883, "t")),
        ("mqtts://me@h/plant/press", Target("h", 8883, "plant/press", "me", tls=True)),
        ("mqtt://[::1]:4000/t/", Target("::1", 4000, "t")),
    ],
)
def test_addresses(text, found):
    """1883 and 8883 are the registered ports of MQTT without and with TLS."""
    assert Target.of(text) == found


@pytest.mark.parametrize(
    "text",
    ["mqtt://h", "mqtt:///t", "http://h/t", "h/t", "mqtt://h:99999/t", "mqtt://h/a/#", "mqtt://h/+/a", "mqtt://h/$SYS",
     "mqtt://me:secret@h/t", "mqtt://me:secret", "mqtt://h/t?secret"],
)  # fmt: skip
def test_what_is_no_address_is_refused_without_repeating_it(tmp_path, capsys, text):
    """PG720 with the form; a password is not printed, and no file is begun."""
    out = tmp_path / "a.csv"
    assert run(["ppi", "log", "VW100", "--out", str(out), "--port", "COM3", "--mqtt", text]) == 1
    said = capsys.readouterr()
    assert "PG720" in said.err
    assert "secret" not in said.out + said.err
    assert not out.exists()


def test_without_the_package_one_line_says_how_to_install_it(tmp_path, capsys, monkeypatch):
    """PG723, before a file is begun."""
    monkeypatch.setitem(sys.modules, "paho.mqtt.client", None)
    out = tmp_path / "a.csv"
    assert run(["ppi", "log", "VW100", "--out", str(out), "--port", "COM3", "--mqtt", "mqtt://h/t"]) == 1
    said = capsys.readouterr().err
    assert "PG723" in said
    assert 'pip install "plcgen[mqtt]"' in said
    assert not out.exists()


def test_names_are_one_level_of_a_topic():
    """The separator and the wildcards of MQTT are written as in web addresses, so no two names become one."""
    assert topic_level("a/b+c#d%e ä") == "a%2Fb%2Bc%23d%25e ä"


def test_the_file_does_not_notice_the_broker(tmp_path):
    """Ten cycles without a broker: the rows are those of a log without --mqtt."""
    found = []
    for name in ("a.csv", "b.csv"):
        day = Day()
        logger, _ = day.logger(tmp_path / name)
        sink, _ = publisher(most=2)
        if name == "b.csv":
            logger._publish = sink.add
        assert logger.run(lambda: False, 10)
        found.append(rows_of(tmp_path / name))
    assert found[0] == found[1]
    assert len(found[0]) == 12


# ---- Through paho-mqtt ----------------------------------------------------------------------------------------


@pytest.fixture
def broker():
    """A broker on this machine."""
    pytest.importorskip("paho.mqtt.client", reason="paho-mqtt is not installed")
    found = Broker()
    yield found
    found.close()


def test_paho_delivers_and_the_will_speaks(broker):
    """User and password arrive; retained values; a cut line lets the will say offline, and paho comes back."""
    target = Target("127.0.0.1", broker.port, "plant/press", "me")
    client = paho_client(target, {"PLCGEN_MQTT_PASSWORD": "secret"})
    client.reconnect_delay_set(0.01, 0.01)
    sink = Publisher(target, [Channel(2, parse_place("VW100"), "VW100")], client, iso, lambda _: None)
    assert broker.greetings.get(timeout=10) == ["me", "secret"]
    assert broker.messages.get(timeout=10) == ("plant/press/state", "online", True)
    broker.cut()
    assert broker.messages.get(timeout=10) == ("plant/press/state", "offline", True)
    assert broker.messages.get(timeout=10) == ("plant/press/state", "online", True)
    sink.add(row(0, 7))
    assert sink.close()
    topic, text, retain = broker.messages.get(timeout=10)
    assert (topic, json.loads(text)["value"], retain) == ("plant/press/2/VW100", 7, True)
    assert broker.messages.get(timeout=10) == ("plant/press/state", "offline", True)
    assert broker.messages.empty()


@pytest.mark.slow
def test_the_command_publishes(broker, tmp_path):
    """As a process: two stations, values retained, offline at the end, exit code 0; the file has its rows."""
    pairs = [Station(values={"VW100": 7}), Station(address=3, values={"M0.0": True})]
    with Serving(Bus(pairs), TcpServer("127.0.0.1:0")) as port:
        command = [sys.executable, "-m", "plcgen", "ppi", "log", "VW100", "3:M0.0", "--out", "a.csv", "--port", port]
        more = ["--count", "2", "--interval", "0.02", "--mqtt", f"mqtt://127.0.0.1:{broker.port}/plant"]
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        done = subprocess.run(
            [*command, *more], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=60, check=False
        )
    assert done.returncode == 0, done.stderr
    values = {topic: text if topic.endswith("state") else json.loads(text) for topic, text in broker.retained.items()}
    assert values.keys() == {"plant/state", "plant/2/VW100", "plant/3/M0.0"}
    assert values["plant/state"] == "offline"
    assert (values["plant/3/M0.0"]["station"], values["plant/3/M0.0"]["item"]) == (3, "M0.0")
    assert (values["plant/3/M0.0"]["value"], values["plant/2/VW100"]["value"]) == (True, 7)
    assert [each["state"] for each in rows_of(tmp_path / "a.csv")] == ["start", "good", "good", "stop"]

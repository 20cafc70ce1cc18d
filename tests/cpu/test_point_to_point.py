"""Blocks of serial modules in the soft CPU. Sources: TIA Portal information system, Point-to-point and CP 341."""

from __future__ import annotations

import pytest

from plcgen.cpu.system.port import Port
from plcgen.cpu.testing import Bench, load_scl
from plcgen.protocols.ppi.sim import Bus as Line
from plcgen.protocols.ppi.sim import Station

REQUEST = bytes.fromhex("681B1B6802006C32010000000000 0E00000401120A10020001000184000320 8B16")
"""Read VB100 of station 2 (seed document 004, table 1)."""

NEW = """
FUNCTION_BLOCK "Talk"
{ S7_Optimized_Access := 'FALSE' }
VAR_INPUT
  send : Bool;
  configure : Bool;
  reset : Bool;
  twice : Bool;
  baud : UInt := 6;
  length : UInt := 33;
END_VAR
VAR_OUTPUT
  done : Bool;
  failed : Bool;
  state : Word;
  sets : Int;
  resets : Int;
  arrived : Bool;
  received : UInt;
  receiveState : Word;
  configState : Word;
END_VAR
VAR
  instSend : Send_P2P;
  instReceive : Receive_P2P;
  instSecond : Receive_P2P;
  instConfig : Port_Config;
  instReset : Receive_Reset;
  request : Array[0..39] of Byte;
  answer : Array[0..9] of Byte;
END_VAR
VAR_TEMP
  tempDone : Bool;
  tempError : Bool;
END_VAR
BEGIN
#instSend(REQ := #send, PORT := 270, BUFFER := #request, LENGTH := #length, DONE => #done, ERROR => #failed,
          STATUS => #state);
#instReceive(PORT := 270, BUFFER := #answer, NDR => #arrived, STATUS => #receiveState, LENGTH => #received);
IF #twice THEN
  #instSecond(PORT := 270, BUFFER := #answer);
END_IF;
#instConfig(REQ := #configure, PORT := 270, PROTOCOL := 0, BAUD := #baud, PARITY := 2, DATABITS := 1, STOPBITS := 1,
            FLOWCTRL := 1, MODE := 4, DONE => #tempDone, ERROR => #tempError, STATUS => #configState);
IF #tempDone THEN
  #sets := #sets + 1;
END_IF;
#instReset(REQ := #reset, PORT := 270, DONE => #tempDone);
IF #tempDone THEN
  #resets := #resets + 1;
END_IF;
END_FUNCTION_BLOCK
DATA_BLOCK "Talk_DB"
{ S7_Optimized_Access := 'FALSE' }
"Talk"
BEGIN
END_DATA_BLOCK
"""


def bench(**port: object) -> tuple[Bench, Port]:
    found = load_scl(NEW)
    line = Line([Station(values={"VB100": 0x22})])
    found.bus.ports[270] = Port(peer=line, **port)  # type: ignore[arg-type]
    found.cpu["Talk_DB.request"] = [*REQUEST, *bytes(7)]
    return found, found.bus.ports[270]


def until(found: Bench, member: str, scans: int = 60) -> int:
    for number in range(1, scans + 1):
        found.call("Talk_DB", 5, send=True)
        if found.cpu[f"Talk_DB.{member}"]:
            return number
    raise AssertionError(member)


def test_send_takes_as_long_as_its_characters() -> None:
    """33 characters of 11 bits at 9600 bit/s are 37.8 ms: DONE in the ninth call of 5 ms, for one call."""
    found, port = bench()
    assert until(found, "done") == 9
    assert found.cpu["Talk_DB.state"] == 0
    assert port.sent[0][1] == REQUEST
    found.call("Talk_DB", 5, send=True)
    assert found.cpu["Talk_DB.done"] is False
    assert found.cpu["Talk_DB.state"] == 0x7000


def test_a_message_arrives_after_the_gap_behind_it() -> None:
    """E5 takes 1.15 ms and the gap of 35 bit times 3.6 ms; it is handed over in the second call that sees it."""
    found, _ = bench()
    until(found, "done")
    assert until(found, "arrived") <= 4
    assert found.cpu["Talk_DB.received"] == 1
    assert found.cpu["Talk_DB.answer[0]"] == 0xE5
    found.call("Talk_DB", 5)
    assert found.cpu["Talk_DB.arrived"] is False
    assert found.cpu["Talk_DB.receiveState"] == 0x7002


def test_status_of_a_running_job() -> None:
    """7001 in the first call, 7002 in the next ones."""
    found, _ = bench()
    found.call("Talk_DB", 5, send=True)
    assert found.cpu["Talk_DB.state"] == 0x7001
    found.call("Talk_DB", 5, send=True)
    assert found.cpu["Talk_DB.state"] == 0x7002


@pytest.mark.parametrize(("member", "value"), [("request[3]", 1), ("length", 32)])
def test_a_job_that_is_disturbed_is_reported(member: str, value: int) -> None:
    """BUFFER and LENGTH must not change before DONE; the line of the call is named."""
    found, _ = bench()
    found.call("Talk_DB", 5, send=True)
    found.cpu[f"Talk_DB.{member}"] = value
    found.call("Talk_DB", 5, send=True)
    (misuse,) = found.cpu.misuses
    assert misuse.code == "PG830"
    assert NEW.splitlines()[misuse.line - 1].startswith("#instSend(")


def test_length_beyond_the_buffer() -> None:
    """41 bytes of a buffer of 40: STATUS 8088, and a misuse."""
    found, port = bench()
    found.call("Talk_DB", 5, send=True, length=41)
    assert found.cpu["Talk_DB.failed"] is True
    assert found.cpu["Talk_DB.state"] == 0x8088
    assert [misuse.code for misuse in found.cpu.misuses] == ["PG834"]
    assert port.sent == []


def test_an_unknown_port() -> None:
    """There is no such hardware identifier: 8080."""
    found, _ = bench()
    found.bus.ports.clear()
    found.call("Talk_DB", 5, send=True)
    assert found.cpu["Talk_DB.state"] == 0x8080


def test_two_receivers_on_one_port() -> None:
    """They take each other's messages."""
    found, _ = bench()
    found.call("Talk_DB", 5, twice=True)
    assert [misuse.code for misuse in found.cpu.misuses] == ["PG837"]


def test_a_message_longer_than_the_buffer() -> None:
    """Eleven bytes do not fit ten."""
    found, port = bench()
    port.inject(0, bytes(11))
    for _ in range(8):
        found.call("Talk_DB", 5)
    assert [misuse.code for misuse in found.cpu.misuses] == ["PG834"]


def test_port_config_sets_the_speed() -> None:
    """BAUD 7 is 19200; before that a line of 19200 bit/s does not understand."""
    found, port = bench(line_baud=19200)
    until(found, "done")
    for _ in range(20):
        found.call("Talk_DB", 5)
        assert found.cpu["Talk_DB.arrived"] is False
    for _ in range(4):
        found.call("Talk_DB", 5, send=False, configure=True, baud=7)
    assert found.cpu["Talk_DB.sets"] == 1
    assert port.baud == 19200
    until(found, "arrived")


def test_port_config_refuses_an_unknown_speed() -> None:
    """BAUD 12 is none: 80A1."""
    found, _ = bench()
    found.call("Talk_DB", 5, configure=True, baud=12)
    assert found.cpu["Talk_DB.configState"] == 0x80A1


def test_receive_reset_throws_messages_away() -> None:
    """What has arrived before is not handed over."""
    found, port = bench()
    found.bus.ports.clear()
    port.inject(0, b"\xe5")
    port.advance(50)
    assert port.waiting
    found.bus.ports[270] = port
    port.calls = 5
    for _ in range(6):
        found.call("Talk_DB", 5, reset=True)
    assert found.cpu["Talk_DB.resets"] == 1
    assert not port.waiting


def test_a_restart_forgets_everything() -> None:
    """Running jobs, stored messages: gone."""
    found, port = bench()
    found.call("Talk_DB", 5, send=True)
    port.inject(0, b"\xe5")
    port.advance(20)
    found.cpu.restart("warm")
    assert not port.waiting
    assert not port.transmitting
    assert found.cpu.jobs == 0


CP = """
FUNCTION_BLOCK "Talk"
VAR_INPUT
  send : BOOL;
  cancel : BOOL;
  enable : BOOL := TRUE;
END_VAR
VAR_OUTPUT
  done : BOOL;
  failed : BOOL;
  arrived : BOOL;
  received : INT;
  state : WORD;
END_VAR
BEGIN
"P_SND_RK"."Talk_Send"(SF := 'S', REQ := send, R := cancel, LADDR := 256, DB_NO := 50, DBB_NO := 1, LEN := 33);
done := "Talk_Send".DONE;
failed := "Talk_Send".ERROR;
state := "Talk_Send".STATUS;
"P_RCV_RK"."Talk_Receive"(EN_R := enable, R := FALSE, LADDR := 256, DB_NO := 50, DBB_NO := 40);
arrived := "Talk_Receive".NDR;
received := "Talk_Receive".LEN;
END_FUNCTION_BLOCK
DATA_BLOCK "Talk_DB" "Talk"
BEGIN
END_DATA_BLOCK
DATA_BLOCK "Talk_Send" "P_SND_RK"
BEGIN
END_DATA_BLOCK
DATA_BLOCK "Talk_Receive" "P_RCV_RK"
BEGIN
END_DATA_BLOCK
DATA_BLOCK DB50
STRUCT
  data : ARRAY[0..99] OF BYTE;
END_STRUCT
BEGIN
END_DATA_BLOCK
"""


def cp() -> tuple[Bench, Port]:
    found = load_scl(CP, dialect="v5")
    found.bus.ports[256] = Port(peer=Line([Station(values={"VB100": 0x22})]))
    found.cpu["DB50.data"] = [33, *REQUEST, *bytes(66)]
    return found, found.bus.ports[256]


def test_a_cp_341_sends_from_a_data_block_and_receives_into_it() -> None:
    """From byte 1 of DB50, to byte 40: DONE and NDR for one call, STATUS 0 without an error."""
    found, port = cp()
    seen = []
    for _ in range(40):
        found.call("Talk_DB", 5, send=True)
        seen.append((found.cpu["Talk_DB.done"], found.cpu["Talk_DB.arrived"]))
        if found.cpu["Talk_DB.arrived"]:
            assert found.cpu["Talk_DB.received"] == 1
    assert [sum(column) for column in zip(*seen, strict=True)] == [1, 1]
    assert found.cpu["DB50.data[40]"] == 0xE5
    assert port.sent[0][1] == REQUEST
    assert found.cpu["Talk_DB.state"] == 0


def test_a_cp_341_can_be_cancelled() -> None:
    """R ends the job without DONE; the next rising edge of REQ sends again."""
    found, port = cp()
    found.call("Talk_DB", 5, send=True)
    found.call("Talk_DB", 5, cancel=True)
    for _ in range(20):
        found.call("Talk_DB", 5, send=False, cancel=False)
        assert found.cpu["Talk_DB.done"] is False
    for _ in range(20):
        found.call("Talk_DB", 5, send=True)
    assert len(port.sent) == 2


def test_a_cp_341_that_is_not_there() -> None:
    """ERROR with a STATUS."""
    found, _ = cp()
    found.bus.ports.clear()
    found.call("Talk_DB", 5, send=True)
    assert found.cpu["Talk_DB.failed"] is True
    assert found.cpu["Talk_DB.state"] == 0x1E0E


def test_nothing_is_received_without_en_r() -> None:
    """EN_R FALSE leaves the message in the module."""
    found, port = cp()
    port.inject(0, b"\xe5")
    for _ in range(20):
        found.call("Talk_DB", 5, enable=False)
    assert port.waiting

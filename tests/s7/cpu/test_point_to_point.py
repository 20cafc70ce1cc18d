"""Blocks of serial modules in the soft CPU. Sources: TIA Portal information system, Point-to-point and CP 341."""

from __future__ import annotations

import pytest

from plcgen.ppi.sim import Bus as Line
from plcgen.ppi.sim import Station
from plcgen.s7.cpu.system.port import Port
from plcgen.s7.cpu.testing import Bench, load_scl

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
    assert port.settings.baud == 19200
    until(found, "arrived")


def test_port_config_refuses_an_unknown_speed() -> None:
    """BAUD 12 is none: 81A1."""
    found, _ = bench()
    found.call("Talk_DB", 5, configure=True, baud=12)
    assert found.cpu["Talk_DB.configState"] == 0x81A1


@pytest.mark.parametrize(
    ("pins", "status"),
    [
        ("PROTOCOL := 2", 0x81A0), ("PARITY := 7", 0x81A2), ("DATABITS := 3", 0x81A3), ("STOPBITS := 0", 0x81A4),
        ("FLOWCTRL := 6", 0x81A5), ("MODE := 5", 0x81AA), ("LINE_PRE := 3", 0x81AB), ("BRK_DET := 2", 0x81AC),
        ("MODE := 4, LINE_PRE := 1", 0x81AB),
    ],
)  # fmt: skip
def test_port_config_refuses_what_its_table_does_not_have(pins: str, status: int) -> None:
    """TIA Portal information system, "Port_Config" and "Error messages"; LINE_PRE 1 exists with four wires only."""
    assert configured(pins, "").cpu["Set_DB.state"] == status


@pytest.mark.parametrize("pins", ["MODE := 0", "MODE := 1", "MODE := 4, FLOWCTRL := 2", "MODE := 4, STOPBITS := 2"])
def test_nobody_understands_a_port_with_other_wires(pins: str) -> None:
    """PPI needs RS485, half duplex; XON/XOFF takes bytes away; one stop bit."""
    found = configured(pins, "")
    assert found.cpu["Set_DB.state"] == 0
    assert not found.bus.ports[270].understood


@pytest.mark.parametrize(
    ("lines", "status", "gap", "length"),
    [
        ("ENDCOND := 16#0C; #c.END.CHARGAP := 35; #c.END.MAXLEN := 512", 0, 35, 512),
        ("ENDCOND := 16#04; #c.END.CHARGAP := 40", 0, 40, 0),
        ("ENDCOND := 0", 0x81C1, 35, 512),
        ("ENDCOND := 16#08; #c.END.MAXLEN := 0", 0x81C3, 35, 512),
        ("ENDCOND := 16#04; #c.END.CHARGAP := 0", 0x81C9, 35, 512),
        ("ENDCOND := 16#04; #c.START.STARTCOND := 16#0A", 0x81C0, 35, 512),
        ("ENDCOND := 16#02", 0, 0, 0),
    ],
)
def test_receive_config_says_what_ends_a_message(lines: str, status: int, gap: int, length: int) -> None:
    """TIA Portal information system, "Receive_Config"; ends that are not known here end no message."""
    found = configured("MODE := 4", f"#c.START.STARTCOND := 16#02; #c.END.{lines};")
    settings = found.bus.ports[270].settings
    assert found.cpu["Set_DB.state"] == status
    assert (settings.gap_bits, settings.max_length) == (gap, length)


def configured(pins: str, lines: str) -> Bench:
    """Port_Config with these pins, or Receive_Config behind these lines; its last STATUS."""
    port = f"REQ := #go, PORT := 270, BAUD := 6, DONE => #done, ERROR => #failed, STATUS => #now, {pins}"
    for name, value in (("PARITY", 2), ("DATABITS", 1), ("STOPBITS", 1), ("FLOWCTRL", 1)):
        port += "" if name in pins else f", {name} := {value}"
    call = "#instC(REQ := #go, PORT := 270, RECEIVE_CONDITIONS := #c, DONE => #done, ERROR => #failed, STATUS => #now);"
    found = load_scl(
        f"""
        FUNCTION_BLOCK "Set"
        {{ S7_Optimized_Access := 'FALSE' }}
        VAR_INPUT go : Bool; END_VAR
        VAR_OUTPUT state : Word; END_VAR
        VAR instP : Port_Config; instC : Receive_Config; c : Receive_Conditions; END_VAR
        VAR_TEMP done : Bool; failed : Bool; now : Word; END_VAR
        BEGIN
        {f"{lines} {call}" if lines else f"#instP({port});"}
        IF #done OR #failed THEN #state := #now; END_IF;
        END_FUNCTION_BLOCK
        DATA_BLOCK "Set_DB"
        {{ S7_Optimized_Access := 'FALSE' }}
        "Set"
        BEGIN
        END_DATA_BLOCK
        """
    )
    found.bus.ports[270] = Port()
    for _ in range(4):
        found.call("Set_DB", 5, go=True)
    return found


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


def test_a_reset_of_a_cp_341_takes_four_calls() -> None:
    """R cancels what the CP does not have yet; DONE comes in the fourth call with R (manual, table 6-15), once."""
    found, port = cp()
    found.call("Talk_DB", 5, send=True)
    done = [found.call("Talk_DB", 5, cancel=True) or found.cpu["Talk_DB.done"] for _ in range(6)]
    assert done == [False, False, False, True, False, False]
    for _ in range(20):
        found.call("Talk_DB", 5, send=False, cancel=False)
        assert found.cpu["Talk_DB.done"] is False
    assert port.sent == []


def test_a_reset_without_a_cp_341_ends_with_an_error() -> None:
    """ERROR and STATUS are output for a RESET, too."""
    found, _ = cp()
    found.bus.ports.clear()
    found.call("Talk_DB", 5, cancel=True)
    assert found.cpu["Talk_DB.failed"] is True
    assert found.cpu["Talk_DB.state"] == 0x1E0E


@pytest.mark.parametrize(("octets", "calls"), [(1, 3), (32, 3), (33, 4), (60, 4)])
def test_a_cp_341_takes_and_hands_over_32_bytes_a_call(octets: int, calls: int) -> None:
    """At least three calls for up to 32 bytes, one more for every 32 begun (manual, table 6-15)."""
    found, port = cp()
    port.deliver(bytes(octets))
    for number in range(1, 10):
        found.call("Talk_DB", 1)
        if found.cpu["Talk_DB.arrived"]:
            assert (number, found.cpu["Talk_DB.received"]) == (calls, octets)
            break
    else:
        pytest.fail("nothing arrived")


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

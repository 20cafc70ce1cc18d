"""PPI masters in other languages than SCL: a statement list that loads its telegram, calls in LAD and FBD.

The telegram is the read of VB100 of the article that test_ppi_audit names: its bytes add up to 8Bh.
"""

from __future__ import annotations

from pathlib import Path

import pytest

import plcgen

HERE = Path(__file__).parent / "ppi"
READ = bytes.fromhex("681B1B6802006C32010000000000 0E0000040112 0A1002000100 0184000320 8B16")

AWL = """DATA_BLOCK DB 10
  STRUCT
    send : ARRAY [0 .. 63] OF BYTE ;
  END_STRUCT ;
BEGIN
END_DATA_BLOCK

FUNCTION FC 10 : VOID
BEGIN
NETWORK
TITLE = 'L B#16#68; is no statement here
      L     DW#16#681B1B68; // the first four at once
      T     DB10.DBD    0;
      L     W#16#200;
      T     DB10.DBW    4;
      AUF   DB    10;
{loads}
      CALL FB 8 , DB 8 (
           SF                       := 'S',
           REQ                      := M     10.0,
           LADDR                    := 256,
           DB_NO                    := 10,
           DBB_NO                   := 0,
           LEN                      := 33,
           DONE                     := M     10.1);
END_FUNCTION
"""

NETWORK = """<?xml version="1.0" encoding="utf-8"?>
<Document><Engineering version="V17" />
<SW.Blocks.FC ID="0"><AttributeList><Interface><Sections xmlns="http://www.siemens.com/automation/Openness/SW/Interface/v5">
<Section Name="Return"><Member Name="Ret_Val" Datatype="Void" /></Section></Sections></Interface>
<Name>Send</Name><Number>20</Number><ProgrammingLanguage>{language}</ProgrammingLanguage></AttributeList><ObjectList>
<SW.Blocks.CompileUnit ID="1" CompositionName="CompileUnits"><AttributeList><NetworkSource>
<FlgNet xmlns="http://www.siemens.com/automation/Openness/SW/NetworkSource/FlgNet/v4"><Parts>
{operands}
{call}
</Parts><Wires>
{wires}
</Wires></FlgNet></NetworkSource><ProgrammingLanguage>{language}</ProgrammingLanguage></AttributeList></SW.Blocks.CompileUnit>
</ObjectList></SW.Blocks.FC></Document>
"""
CALL = '<Call UId="90"><CallInfo Name="P_SND_RK" BlockType="FB" /></Call>'
PART = '<Part Name="Send_P2P" Version="4.0" UId="90" />'


def network(language: str, call: str, **operands: str) -> str:
    """A document with one call; an operand in quotes is a global variable, anything else a constant."""
    access, wires = [], []
    for uid, (name, value) in enumerate(operands.items(), 21):
        if value.startswith('"'):
            inner = "".join(f'<Component Name="{step}" />' for step in value.replace('"', "").split("."))
            access.append(f'<Access Scope="GlobalVariable" UId="{uid}"><Symbol>{inner}</Symbol></Access>')
        else:
            inner = f"<Constant><ConstantType>Int</ConstantType><ConstantValue>{value}</ConstantValue></Constant>"
            access.append(f'<Access Scope="LiteralConstant" UId="{uid}">{inner}</Access>')
        wires.append(f'<Wire UId="{uid + 20}"><IdentCon UId="{uid}" /><NameCon UId="90" Name="{name}" /></Wire>')
    parts = {"operands": "\n".join(access), "wires": "\n".join(wires)}
    return NETWORK.format(language=language, call=call, **parts)


def loads(data: bytes, first: int) -> str:
    """One load for each byte that differs from the one before: the accumulator keeps its value."""
    lines, before = [], -1
    for at, byte in enumerate(data[first:], first):
        lines += [f"      L     B#16#{byte:X};"] * (byte != before) + [f"      T     DBB   {at};"]
        before = byte
    return "\n".join(lines)


def audited(folder: Path, spec: str, **files: str):
    for name, text in files.items():
        (folder / name.replace("_", ".")).write_text(text, "utf-8")
    return plcgen.audit(folder, spec=HERE / f"{spec}.yaml")


def test_a_statement_list_loads_its_telegram(tmp_path: Path) -> None:
    result = audited(tmp_path, "cp341", PPI_awl=AWL.format(loads=loads(READ, 6)))
    assert result.diagnostics == ()
    verdicts = [check.verdict for check in result.checks()]
    assert "a right telegram of read_vb100" in verdicts
    assert "sends DB10 filled in FC10 byte 0" in verdicts


@pytest.mark.parametrize(
    ("old", "new", "code", "says"),
    [
        ("B#16#8B", "B#16#8A", "PG671", "the checksum FCS is 8Ah, the bytes from DA on add up to 8Bh"),
        ("LEN                      := 33", "LEN                      := 27", "PG673", "the telegram has 33: 6 too few"),
        ("DW#16#681B1B68", "DW#16#681B1C68", "PG670", "the repeated length is 28"),
        ("DBB_NO                   := 0", "DBB_NO                   := 1", "PG674", "the telegram begins at byte 0"),
    ],
)
def test_damage_to_a_statement_list(tmp_path: Path, old: str, new: str, code: str, says: str) -> None:
    text = AWL.format(loads=loads(READ, 6))
    assert text.count(old) == 1
    text = text.replace(old, new)
    (found,) = audited(tmp_path, "cp341", PPI_awl=text).diagnostics
    assert (found.code, text.splitlines()[found.span.line - 1].strip().split()[0]) == (
        code,
        {"PG671": "T", "PG673": "LEN", "PG670": "T", "PG674": "DBB_NO"}[code],
    )
    assert says in found.message


def test_what_a_statement_list_computes_is_taken_for_right(tmp_path: Path) -> None:
    """A value of the accumulator behind anything but a transfer is unknown: so is the checksum over it."""
    reference = "T     DBB   11;"
    text = AWL.format(loads=loads(READ, 6)).replace(reference, f"L     MB 5;\nINC   1;\n{reference}\nL     B#16#0;")
    result = audited(tmp_path, "cp341", PPI_awl=text.replace("B#16#8B", "B#16#00"))
    assert result.diagnostics == ()
    assert any("come at run time" in check.verdict for check in result.checks())


@pytest.mark.parametrize("language", ["LAD", "FBD"])
@pytest.mark.parametrize(("length", "codes"), [("33", []), ("27", ["PG673"])])
def test_calls_in_networks(tmp_path: Path, language: str, length: str, codes: list[str]) -> None:
    operands = {"SF": "'S'", "LADDR": "256", "DB_NO": "10", "DBB_NO": "0", "LEN": length}
    document = network(language, CALL, **operands)
    blocks = (HERE / "cp341" / "PPI.AWL").read_text("utf-8").partition("FUNCTION FC")[0]
    result = audited(tmp_path, "cp341", DB_awl=blocks, Send_xml=document)
    found = [d for d in result.diagnostics if d.code != "PG814"]
    assert [d.code for d in found] == codes
    assert [d.span.line for d in found] == [document[: document.index("<Call")].count("\n") + 1] * len(codes)
    assert any('P_SND_RK in FC20 "Send"' in str(check) for check in result.checks())


@pytest.mark.parametrize(("length", "codes"), [("33", []), ("39", ["PG673"])])
def test_instructions_in_networks(tmp_path: Path, length: str, codes: list[str]) -> None:
    document = network("LAD", PART, REQ="1", PORT="270", BUFFER='"Line".read', LENGTH=length, DONE='"Line".done')
    line = (HERE / "cm1241" / "Line.db").read_text("utf-8")
    result = audited(tmp_path, "cm1241", Line_db=line, Send_xml=document)
    assert [d.code for d in result.diagnostics if d.code != "PG814"] == codes

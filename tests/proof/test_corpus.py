"""A corpus of damage to delivered files: what is damaged, and where. The manifest is made anew: only contents tell."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from plcgen import api
from tests.projects import generated_example
from tests.proof.damaging import damaged, findings, spec_of

TIA, NEW, V5 = "s7-300_6ra80_dp_tia", "s7-1500_g120_pn", "s7-300_mm440_dp"
BLOCKS = f"{V5} per block"
MAIN_TEXT, JOB = "scl/Main.scl", "scl/SetRamps.scl"
# what: (example, file, what stands there, what stands there instead)
CORPUS: dict[str, tuple[str, str, str, str]] = {}


def damage(what: str, example: str, file: str, old: str, new: str) -> None:
    """Add a row."""
    assert what not in CORPUS, what
    CORPUS[what] = (example, file, old, new)


for name, old, new in (
    ("execute is TRUE at start", "execute : Bool;", "execute : Bool := TRUE;"),
    ("busy is TRUE at start", "busy : Bool;", "busy : Bool := TRUE;"),
    ("status at start", "status : Word;", "status : Word := 16#8000;"),
    ("another start value of an input", "rampUpTime : Real := 10.0", "rampUpTime : Real := 11.0"),
    ("no start value of an input", "rampDownTime : Real := 10.0", "rampDownTime : Real"),
    ("an input of another type", "rampUpTime : Real := 10.0", "rampUpTime : DInt := 10"),
    ("a signal of another type", "status : Word;", "status : DWord;"),
    ("a signal is missing", "      done : Bool;  // the job ended well\n", ""),
    ("a signal with another name", "error : Bool;", "fault : Bool;"),
    ("another member", "execute : Bool;", "execute : Bool; again : Bool;"),
    ("a value has another type", "actualSpeed : Real;", "actualSpeed : DWord;"),
    ("an array is shorter", "Array[0..7] of UInt", "Array[0..6] of UInt"),
    ("a start value of a result", "actualSpeed : Real;", "actualSpeed : Real := 1.0;"),
    ("it is retentive", "NON_RETAIN\n", ""),
    ("access is optimized", "'FALSE'", "'TRUE'"),
    ("read only", "NON_RETAIN\n", "NON_RETAIN\nREAD_ONLY\n"),
    ("unlinked", "NON_RETAIN\n", "NON_RETAIN\nUNLINKED\n"),
    ("another name", 'DATA_BLOCK "DriveJobs"', 'DATA_BLOCK "DriveJob"'),
    ("another author", "AUTHOR : plcgen", "AUTHOR : me"),
):
    damage(f"DriveJobs: {name}", NEW, "db/DriveJobs.db", old, new)
for name, old, new in (
    (
        "execute is TRUE at start",
        '<Member Name="execute" Datatype="Bool">',
        '<Member Name="execute" Datatype="Bool"><StartValue>TRUE</StartValue>',
    ),
    ("another start value", "<StartValue>10.0</StartValue>", "<StartValue>10.5</StartValue>"),
    ("a signal of another type", 'Name="status" Datatype="Word"', 'Name="status" Datatype="Int"'),
    ("a member with another name", 'Name="busy"', 'Name="idle"'),
    ("retentive", 'Name="setRamps" Datatype="Struct"', 'Name="setRamps" Datatype="Struct" Remanence="Retain"'),
    ("optimized access", "<MemoryLayout>Standard", "<MemoryLayout>Optimized"),
    ("another number", "<Number>", "<Number>9"),
    ("automatic number", "<AutoNumber>false", "<AutoNumber>true"),
    ("another language", "<ProgrammingLanguage>DB", "<ProgrammingLanguage>LAD"),
    ("another name", "<Name>DriveJobs</Name>", "<Name>DriveJob</Name>"),
):
    damage(f"DriveJobs.xml: {name}", NEW, "xml/DriveJobs.xml", old, new)
for name, old, new in (
    ("another OB", "<Number>1</Number>", "<Number>35</Number>"),
    ("another event class", "ProgramCycle", "CyclicInterrupt"),
    ("another language", "<ProgrammingLanguage>SCL", "<ProgrammingLanguage>LAD"),
    ("automatic number", "<AutoNumber>false", "<AutoNumber>true"),
    ("standard access", "<MemoryLayout>Optimized", "<MemoryLayout>Standard"),
    ("another version of its header", "<HeaderVersion>0.1", "<HeaderVersion>0.2"),
):
    damage(f"Main.xml: {name}", NEW, "xml/Main.xml", old, new)
for file in ("scl/SetRamps.scl", "scl/ReadSpeed.scl", "scl/DriveCalls.scl", "scl/DriveGate.scl", "scl/DriveTicket.scl"):
    damage(f"{file}: optimized access", NEW, file, "'FALSE'", "'TRUE'")
    damage(f"{file}: a token of code", NEW, file, ":=", ":= 1 +")
    damage(f"{file}: another version", NEW, file, "VERSION : ", "VERSION : 9")
for block in ("SetRamps", "ReadFaults", "DriveChannel", "DriveCalls", "DriveGate", "DriveTicket"):
    damage(f"{block}.xml: another number", NEW, f"xml/{block}.xml", "<Number>", "<Number>9")
    damage(
        f"{block}.xml: another language",
        NEW,
        f"xml/{block}.xml",
        "<ProgrammingLanguage>SCL",
        "<ProgrammingLanguage>STL",
    )
    damage(
        f"{block}.xml: optimized access", NEW, f"xml/{block}.xml", "<MemoryLayout>Standard", "<MemoryLayout>Optimized"
    )
for name, file, old, new in (
    ("a member of a type in the document", "xml/typeDriveUnit.xml", 'Datatype="Int"', 'Datatype="DInt"'),
    ("a member of a type in the source", "udt/typeDriveUnit.udt", " : Int", " : DInt"),
    ("a unit of another type", "db/PumpUnit.db", '"typeDriveUnit"', '"typeDriveGate"'),
    ("a unit with a start value", "db/PumpUnit.db", "BEGIN\n", "BEGIN\n  unit.next := 1;\n"),
    ("an instance of another block", "db/DriveCalls_DB.db", '\n"DriveCalls"', '\n"DriveGate"'),
    (
        "an instance of another block in the document",
        "xml/DriveCalls_DB.xml",
        "<InstanceOfName>DriveCalls",
        "<InstanceOfName>DriveGate",
    ),
    ("a version of an instruction", "xml/DriveChannel.xml", 'Version="', 'Version="9'),
):
    damage(name, NEW, file, old, new)
for name, old, new in (
    ("another address", "%M50.0", "%M50.1"),
    ("another type", "readRampUpExecute;Bool", "readRampUpExecute;Word"),
    ("another name", "readRampUpDone", "readRampUpReady"),
    ("two tags exchanged", "readRampUpExecute;Bool;%M50.0", "readRampUpExecute;Bool;%M150.0"),
    ("a tag is missing", "readRampUpDone;Bool;%M50.5;done: Read the ramp-up time P50303\n", ""),
    ("another header", "Logical Address", "Address"),
):
    damage(f"tags.csv: {name}", TIA, "tags.csv", old, new)
for name, old, new in (
    ("another address", "%M50.0", "%M50.1"),
    ("another type", "<DataTypeName>Bool", "<DataTypeName>Int"),
    ("another name", "<Name>readRampUpDone", "<Name>readRampUpReady"),
):
    damage(f"tag table document: {name}", TIA, "xml/DriveJobTags.xml", old, new)
for name, old, new in (
    ("another place", "DB3.DBB0", "DB3.DBB1"),
    ("another data block", "DB4.DBD6", "DB5.DBD6"),
    ("a member that is none", 'RD_DataBuffer"".ParameterValue', 'RD_DataBuffer"".Value'),
    ("execute is set", "M50.0;Bool;", "M50.0;Bool;TRUE"),
    ("done is set", "M50.5;Bool;", "M50.5;Bool;TRUE"),
    ("a flag that is none", "M50.0", "M51.0"),
    ("a row is missing", '"""RD_DataBuffer"".ParameterValue";DB4.DBD6;FloatingPoint;\n', ""),
    ("another header", "display format", "format"),
):
    damage(f"watch table: {name}", TIA, "watch/ReadRampUp.csv", old, new)
damage("watch table document: another row", TIA, "xml/Watch_ReadRampUp.xml", "readRampUp.busy", "readRampUp.done")
for name, old, new in (
    ("another number", '"FB    474   ","FB    474 "', '"FB    475   ","FB    475 "'),
    ("another type of an instance", '"DB    471   ","FB    473 "', '"DB    471   ","FB    474 "'),
    ("another kind", '"UDT   470   ","UDT   470 "', '"UDT   470   ","DB    470 "'),
    ("a block is missing", '"DriveGate               ","FB ', '"DriveGates              ","FB '),
    ("another flag", '"M      10.0 "', '"M      10.2 "'),
    ("another type of a flag", '"MW     22   ","WORD ', '"MW     22   ","INT  '),
    ("another name of a flag", "readParamsExecute", "readParamsStart"),
):
    damage(f"symbols.sdf: {name}", V5, "symbols.sdf", old, new)
for name, old, new in (
    (
        "a type behind its use",
        "typeDriveOrder\ntypeDriveTurn\ntypeDriveAsk\ntypeDriveUnit\n",
        "typeDriveUnit\ntypeDriveOrder\ntypeDriveTurn\ntypeDriveAsk\n",
    ),
    ("an instance in front of its block", "DriveCalls\nDriveCalls_DB", "DriveCalls_DB\nDriveCalls"),
    ("a source is missing", "DriveGate\n", ""),
    ("a source twice", "DriveGate\n", "DriveGate\nDriveGate\n"),
    ("a source that is none", "DriveGate\n", "DriveGates\n"),
    ("with Main", "DriveCalls_DB\n", "DriveCalls_DB\nMain\n"),
):
    damage(f"compile.inp: {name}", BLOCKS, "compile.inp", old, new)
for name, old, new in (
    ("another value", "| 11.0 |", "| 12.0 |"),
    ("another parameter", "| P1120 |", "| P1121 |"),
    ("another drive", "| mm440 | P1121", "| mm441 | P1121"),
    ("another block", "| WriteParams | mm440 | P1120", "| ReadParams | mm440 | P1120"),
    ("an input instead of a constant", "| 22.0 |", "| input, 22.0 if nothing is connected |"),
    ("another source", "`S7-300_MM440_DP.scl`", "`S7-300_MM440.scl`"),
):
    damage(f"IMPORT.md: {name}", V5, "IMPORT.md", old, new)
for name, old, new in (
    (
        "two sources exchanged",
        "3. `udt/typeDriveAsk.scl`\n4. `udt/typeDriveUnit.scl`",
        "3. `udt/typeDriveUnit.scl`\n4. `udt/typeDriveAsk.scl`",
    ),
    ("a source is missing", "17. `scl/DriveGate.scl`\n", ""),
    ("a source in another folder", "`scl/DriveGate.scl`", "`db/DriveGate.scl`"),
    ("a number of the order", "17. `scl/DriveGate.scl`", "71. `scl/DriveGate.scl`"),
    ("a sentence in front of the order", "\n## Order", "\nThe drive has 5 parameters.\n\n## Order"),
    ("with Main", "without `Main`", "with `Main`"),
):
    damage(f"IMPORT.md, a file for each block: {name}", BLOCKS, "IMPORT.md", old, new)
for name, old, new in (
    ("another offset", "| 6 | DB3.DBW6 | Para_No", "| 7 | DB3.DBW6 | Para_No"),
    ("another address", "DB3.DBW6", "DB3.DBW8"),
    ("another size", '"WR_DataBuffer", 10 bytes', '"WR_DataBuffer", 12 bytes'),
    ("another data block", '### DB3 "WR_DataBuffer"', '### DB9 "WR_DataBuffer"'),
    ("another name", "| Para_No |", "| Para_Nr |"),
    ("another type", "| ParameterValue | Real |", "| ParameterValue | DWord |"),
    ("another start value", "16#C47F", "16#C47E"),
):
    damage(f"LAYOUT.md: {name}", TIA, "LAYOUT.md", old, new)
for name, old, new in (
    ("a type behind its use", '"typeDriveOrder.xml",\n        "typeDriveTurn.xml"', '"typeDriveTurn.xml"'),
    ("a document that is none", '"SetRamps.xml"', '"SetRamp.xml"'),
    ("Main without being asked for", '"switch": "Main"', '"switch": ""'),
    ("types as blocks", '"kind": "type"', '"kind": "block"'),
    ("no list", '"steps"', '"stages"'),
):
    damage(f"import.json: {name}", NEW, "xml/import.json", old, new)
damage("import.ps1: a command more", NEW, "xml/import.ps1", "Set-StrictMode", "calc; Set-StrictMode")
damage("import.ps1: overwrites without being asked", NEW, "xml/import.ps1", "if ($Overwrite)", "if ($true)")


def test_the_corpus_is_large() -> None:
    """At least a hundred kinds of damage."""
    assert len(CORPUS) >= 100


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Copies of the examples, which each damage is put into and taken out of."""
    root = tmp_path_factory.mktemp("delivered")
    for name in (TIA, NEW, V5):
        shutil.copytree(generated_example(name), root / name)
    shutil.copytree(spec_of(BLOCKS).with_name("out"), root / BLOCKS)
    return root


@pytest.mark.parametrize("example", [TIA, NEW, V5, BLOCKS])
def test_nothing_is_wrong_without_damage(example: str, folders: Path) -> None:
    """The examples as they are generated."""
    assert findings(example, folders / example) == []


@pytest.mark.parametrize("what", CORPUS)
def test_damage_is_noticed(what: str, folders: Path) -> None:
    """By what is written in the files: their hashes are right. What only running shows is run."""
    example, file, old, new = CORPUS[what]
    folder = folders / example
    with damaged(folder, [(file, old, new)], "cp1252" if example.startswith(V5) else "utf-8"):
        if not findings(example, folder):
            result = api.verify(spec_of(example), folder, faults="none")
            assert not result.ok

"""BICO values against what operating instructions print, and by hand from their table of bits."""

import pytest

from plcgen import api
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.wire.bico import parse_bico, read_bico
from plcgen.ds47.wire.dissect import dissect_request


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("r722.2", "02D2FC02"),  # G110M operating instructions p. 198
        ("r0722.2@self", "02D2FC02"),
        ("r53010@1", "CF120400"),  # DCM operating instructions p. 453
        ("r722.2@3", "02D20C02"),  # 3 << 10 = 0C00h
        ("p2900[1]", "0B54FC01"),
        ("r1.1023@62", "0001FBFF"),  # 62 << 10 | 3FFh
    ],
)
def test_values_are_those_of_the_manuals(text, value):
    """Bits 31..16 parameter number, 15..10 drive object, 9..0 index; 3Fh is the addressed drive object."""
    source = parse_bico(text)
    assert f"{source.value:08X}" == value
    assert read_bico(source.value) == source


@pytest.mark.parametrize("text", ["r0", "r65536", "r722.1024", "r722.2@63", "r722.2@", "r722@me", "722.2", "x722.2"])
def test_what_is_no_source(text):
    """No parameter 0, ten bits of index, 3Fh only as self."""
    assert parse_bico(text) is None


def test_a_dissected_change_names_the_source():
    """A reader of a telegram sees the source beside the number."""
    change = bytes.fromhex("01 02 01 01 10 01 03 48 00 00 07 01 02 D2 FC 02")
    assert dissect_request(change)[-1].note == "Unsigned32, as a BICO value r722.2"
    number = bytes.fromhex("01 02 01 01 10 01 03 48 00 00 07 01 00 00 00 05")
    assert dissect_request(number)[-1].note == "Unsigned32"


SPEC = """\
plc: {{name: a, family: s7-300, toolchain: tia-v16}}
drives: {{d: {{device: {device}, address: 256{more}}}}}
jobs: {{j: {{drive: d, write: {{P840: {value}}}, allow: {{P840: agreed}}, request: {{db: 5}}}}}}
"""


def checked(folder, value, device="sinamics-g120", more=""):
    """A spec that writes P840."""
    path = folder / "job.yaml"
    path.write_text(SPEC.format(device=device, value=value, more=more), "utf-8")
    return api.check(path)


def test_a_spec_writes_the_value_of_the_manual(tmp_path):
    """The telegram ends with 02 D2 FC 02, and the list of writes names the source."""
    (job,) = checked(tmp_path, "r722.2").project.plan(DrivePlan).jobs
    assert job.telegrams[0].request.data.hex(" ").upper().endswith("07 01 02 D2 FC 02")
    assert api.generate(tmp_path / "job.yaml", tmp_path / "out").ok
    assert "| r722.2 |" in (tmp_path / "out" / "IMPORT.md").read_text("utf-8")


def test_a_micromaster_has_no_drive_object_to_name(tmp_path):
    """Its values keep zeros there, and another drive object is refused."""
    more = ", parameters: {P840: {type: Unsigned32, bico: true}}"
    (job,) = checked(tmp_path, "r722.2", "micromaster-4", more).project.plan(DrivePlan).jobs
    assert job.uses[0].data == bytes.fromhex("02D20002")
    (told,) = checked(tmp_path, "r722.2@3", "micromaster-4", more).diagnostics
    assert (told.code, told.help) == ("PG211", "write r722.2")


@pytest.mark.parametrize(
    ("start", "messages"),
    [
        ("16#02D2FC02", []),
        ("16#02D20402", []),  # drive object 1 by its number, which is the addressed one
        ("16#02D20002", ["Value holds r722.2@0 (02 D2 00 02), the value of P840 is r722.2 (02 D2 FC 02)"]),
        ("16#02D20802", ["Value holds r722.2@2 (02 D2 08 02), the value of P840 is r722.2 (02 D2 FC 02)"]),
    ],
)
def test_the_owner_of_a_right_block_is_left_alone(tmp_path, start, messages):
    """The audit takes 3Fh and the number of the addressed drive object for the same, anything else for a mistake."""
    assert checked(tmp_path, "r722.2").ok
    source = tmp_path / "request.db"
    members = ["Ref", "ID", "Axis", "Num_of_Para", "Para_Attribute", "Num_of_Element"]
    values = (1, 2, 1, 1, 0x10, 1)
    declared = "".join(f"{name} : BYTE := 16#{value:02X};\n" for name, value in zip(members, values, strict=True))
    source.write_text(
        "DATA_BLOCK \"Request\"\n{ S7_Optimized_Access := 'FALSE' }\nVERSION : 0.1\nNON_RETAIN\nSTRUCT\n"
        f"{declared}Para_No : WORD := 16#0348;\nSubindex : WORD := 16#0;\nValue_Format : BYTE := 16#07;\n"
        f"No_of_Element : BYTE := 16#01;\nValue : DWORD := {start};\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n",
        "utf-8",
    )
    found = [d.message for d in api.audit(source, spec=tmp_path / "job.yaml").diagnostics if d.code == "PG656"]
    assert found == messages

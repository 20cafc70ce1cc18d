"""Messages of drives: what their lists say, how they are asked for, what an HMI gets of them."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.diagnostics import DiagnosticError
from plcgen.ds47 import messages
from plcgen.ds47.devices import device_names, find_device
from tests.evidence import lists as tool

_MESSAGE = """### {head}

**Drive object:**

{objects}

**Message value:**

-

**Message class:**

C (1)

**{reaction}:**

OFF2 (NONE,
OFF1)

**{acknowledge}:**

IMMEDIATELY

**Cause**

Toy.
"""


def _text(key: str, device: str = "") -> str:
    page = api.explain(key, device)
    assert page is not None
    return "\n".join([page.title, *(f"{heading}: {text}" for heading, text in page.sections)])


def _help(package: str, *messages_: tuple[str, str], new: bool = False) -> str:
    """A page of messages in the form of the public copy; firmware 6 has other headings."""
    words = {"reaction": "Response", "acknowledge": "Acknowledgment"} if new else {
        "reaction": "Reaction", "acknowledge": "Acknowledge"
    }  # fmt: skip
    texts = [_MESSAGE.format(head=head, objects=objects, **words) for head, objects in messages_]
    return "\n".join([f"package: {package}", *texts])


def test_a_table_joins_the_lists_by_meaning(tmp_path: Path) -> None:
    """A line for each meaning, the families of a list told apart by its drive objects; what names none is left out."""
    old = _help(
        "StdrAlG120enUS",
        ("F00100 (N, A) One  title", "G120C_PN, CU240B-2, ET200"),
        ("F00100 Other title &gt; 1", "CU250S_V_PN"),
        ("A00200 Of nobody", "ET200"),
    )
    (tmp_path / "SINAMICS Alarms G120.md").write_text(old, "utf-8")
    new = _help("sdral451enUS", ("F00100 (N, A) One title", ""), new=True)
    (tmp_path / "SINAMICS Alarms G220.md").write_text(new, "utf-8")
    assert tool.messages_text(tmp_path).splitlines() == [
        "# cu240=StdrAlG120enUS, cu250s=StdrAlG120enUS, g120c=StdrAlG120enUS, g220=sdral451enUS",
        "\t".join(messages.COLUMNS),
        "100\tF\t\tOther title > 1\tC (1)\tOFF2 (NONE, OFF1)\tIMMEDIATELY\tcu250s",
        "100\tF\tN A\tOne title\tC (1)\tOFF2 (NONE, OFF1)\tIMMEDIATELY\tcu240 g120c g220",
    ]


def test_no_family_lacks_reactions() -> None:
    """Every fault has a reaction and an acknowledgement, of firmware 6 too."""
    faults = [one for one in messages.all_messages(messages.FAMILIES) if one.kind == "F"]
    assert len(faults) > 1000
    assert [one.name for one in faults if not (one.reaction and one.acknowledge)] == []


@pytest.mark.parametrize(
    ("number", "family", "kind", "also", "title", "reaction", "acknowledge"),
    [
        (7011, "vector", "F", (), "Drive: Motor overtemperature", "OFF2 (NONE, OFF1, OFF3, STOP2)", "IMMEDIATELY"),
        (30001, "g120c", "F", (), "Power unit: Overcurrent", "OFF2", "IMMEDIATELY"),
        (30001, "s210_fw5", "F", (), "Drive: overcurrent", "OFF2", "IMMEDIATELY"),
        (7901, "g220", "F", (), "Drive: Motor overspeed", "OFF2 (IASC/DCBRK)", "IMMEDIATELY"),
        (3505, "cu230p", "F", ("N", "A"), "Analog input wire breakage", "OFF1 (NONE, OFF2)", "IMMEDIATELY (POWER ON)"),
    ],
)
def test_the_table_says_what_is_printed(
    number: int, family: str, kind: str, also: tuple[str, ...], title: str, reaction: str, acknowledge: str
) -> None:
    """As the list manuals of S120 and G120 and the TIA Portal information system (V19) print them."""
    (found,) = messages.find(number, [family])
    assert (found.kind, found.also, found.title) == (kind, also, title)
    assert (found.reaction, found.acknowledge) == (reaction, acknowledge)


def test_a_message_is_asked_for_as_a_drive_shows_it() -> None:
    """Letter, zeros, and the kinds that it can be set to may be there or not; another kind is another message."""
    assert {messages.named(text) for text in ("F07011", "f7011", "F 07011 (N, A)")} == {("F", 7011)}
    assert [messages.named(text) for text in ("PG209", "16#8401", "F3", "7011F", "DF80B500")] == [None] * 5
    assert _text("F7011") == _text("F07011")
    assert _text("07011") == _text("F07011"), "five digits are a number of a message, four a word"
    assert _text("7011").startswith("not a status word")
    assert _text("C840").startswith("not a status word")
    assert api.explain("A30001") is None, "F30001 cannot be set to an alarm"
    assert api.explain("F7011", "sinamics-v90") is None, "no list of this device's messages is public"


def test_families_differ() -> None:
    """Without a device every title stands with its families; with one there is only its own."""
    text = _text("F30001")
    assert "2 titles, by family" in text
    assert "Drive: overcurrent" in text
    assert "Power unit: Overcurrent" in text
    own = _text("F30001", "sinamics-s210")
    assert own.startswith("Drive: overcurrent\n")
    assert "Power unit" not in own
    assert "r945 has the number (30001)" in own
    assert "r2122 has the number (7012)" in _text("A07012", "sinamics-g120c")
    assert "sdral400enUS" in own


def test_a_parameter_a_bit_and_a_value_are_explained() -> None:
    """As the lists of S120 (VECTOR) and S210 print r0002 and r0899; what no list states is not made up."""
    assert 'Switching on inhibited - set "OC/OFF2" = "1"' in _text("r0002 = 42", "sinamics-s120")
    assert "bit 2: Operation enabled (No/Yes)" in _text("r899.2", "sinamics-s120")
    told = _text("r899.11", "sinamics-s120")
    assert "Pulses enabled (No/Yes) (vector, servo); Precharging complete (No/Yes) (a_inf" in told, (
        "of each object its own"
    )
    assert "bit 2: Operation enabled (No/Yes) (inferred)" in _text("r899.2", "sinamics-g120"), "of the list of VECTOR"
    assert "7777: not stated" in _text("r2=7777", "sinamics-s120")
    assert "Save parameters" in _text("p971", "sinamics-g120c")
    assert "Unsigned8" in _text("c0840", "sinamics-g220"), "a sink with a fixed value"
    assert api.explain("p971", "sinamics-g220") is None, "a G220 has no P971"
    with pytest.raises(DiagnosticError) as raised:
        api.explain("F30001", "sinamics-g12")
    assert [one.code for one in raised.value.diagnostics] == ["PG201"]


def test_every_family_belongs_to_a_device() -> None:
    """Profiles name the families that the table has, and none is left over."""
    named = {family for name in device_names() for family in find_device(name).messages}
    assert named == set(messages.FAMILIES)
    assert all(any(messages.all_messages([family])) for family in named)


def test_an_own_profile_has_the_messages_of_the_device_that_it_is_like(tmp_path: Path) -> None:
    """As it has its parameters."""
    profile = tmp_path / "pump.yaml"
    profile.write_text(
        "title: Pump\nsource: nameplate\nlike: sinamics-g120c\n"
        "record_index: {profinet-local: 47, default: profinet-local}\ndrive_object: {default: 1}\n",
        "utf-8",
    )
    assert find_device(str(profile)).messages == ("g120c",)


def test_the_page_counts_the_meanings() -> None:
    """docs/devices.md: a line of the table is a meaning."""
    page = (Path(__file__).parents[2] / "docs/devices.md").read_text("utf-8")
    assert f"{sum(1 for _ in messages.all_messages(messages.FAMILIES)):,} meanings" in page

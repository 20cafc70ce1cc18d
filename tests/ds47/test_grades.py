"""Messages that rest on a fact of the catalogue say how it is known, unless it was read."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api

WORDS = {
    "read": "",
    "inferred": " (inferred, not read in a manual)",
    "recalled": " (from general knowledge, not read in a manual)",
}
ROWS = {
    "P10": "{title: Word, type: Integer16, harmless: a colour, values: {blue: 1}}",
    "P11": "{title: Text, type: 'VisibleString[4]', harmless: a colour}",
    "P12": "{title: Octets, type: 'OctetString[4]', harmless: a colour}",
    "P13": "{title: Long, type: Float64, harmless: a colour}",
    "P14": "{title: Real, type: FloatingPoint, harmless: a colour, min: 0, max: 9}",
    "P15": "{title: Source, type: Unsigned32, bico: true, harmless: a colour}",
    "P16": "{title: Sent, type: Integer16, access: w, harmless: a colour}",
    "r17": "{title: Shown, type: Integer16}",
    "P18": "{title: Row, type: Integer16, array: 4, harmless: a colour}",
    "P19": "{title: Long row, type: FloatingPoint, array: 65535, harmless: a colour}",
    "P20": "{title: Name, type: 'VisibleString[4]', array: 9, harmless: a colour}",
    "P899": "{title: State, type: FloatingPoint, access: r}",
}
CASES = [
    ("PG206", "write: {'P18[7]': 1}", "P18 has the indexes 0..3{}, not 7"),
    ("PG206", "read: ['P20[1]']", "P20[1]{as VisibleString[4]}: the elements of a string"),
    ("PG207", "write: {r17: 1}", "r17 (Shown) can only be read{}"),
    ("PG207", "read: [P16]", "P16 (Sent) can only be written{}"),
    ("PG208", "write: {P10: 70000}", "not 70000{}"),
    ("PG208", "write: {P11: fives}", "5 octets do not fit VisibleString[4]{}"),
    ("PG208", "write: {P12: '0329'}", "OctetString[4] takes 4 octets{}, not 2"),
    ("PG209", "write: {P14: 10.0}", "P14 = 10 is outside its limits 0..9{}"),
    ("PG211", "write: {P10: green}", '"green" is not a value of type Integer16{}'),
    ("PG211", "write: {P11: 3}", "VisibleString{} takes text"),
    ("PG211", "write: {P12: zz}", '"zz" is not a value of type OctetString{}'),
    ("PG212", "read: [{parameter: P10, type: Unsigned32}]", "P10 is Integer16 in the catalogue{}, not Unsigned32"),
    ("PG220", "read: [P13]", "P13 is Float64{}: an S7-300 holds it only as 8 bytes"),
    ("PG246", "write: {P16: 1}, verify: readback", "it can only be written{}"),
    ("PG249", "compare: {P11: four}", "P11 is VisibleString{}: the list of deviations"),
    ("PG251", "sequence: [{until: {P14.1: 1}}]", "a FloatingPoint{} has no bits"),
    ("PG251", "sequence: [{until: {P10.16: 1}}]", "a Integer16{} has the bits 0 to 15, not 16"),
    ("PG251", "sequence: [{until: {P10: '< -32768'}}]", "a Integer16{} is never < -32768"),
    ("PG251", "sequence: [{until: {P13: '> 1.0'}}]", "no type for Float64{}"),
    ("PG255", "write_recipe: r", "P11 is VisibleString{}: a recipe takes only numbers"),
    ("PG257", "write: {P10: 1}, verify: readback, on_error: restore", "r899 of ./acme.yaml is FloatingPoint{}:"),
    ("PG259", "write: {P14.1: 1}", "P14 is FloatingPoint{}, which has no bits"),
    ("PG259", "write: {P10.16: 1}", "P10 is Integer16{}: its bits are 0..15, not 16"),
    ("PG259", "write: {P15.1: 1}", "P15 is a source{}, not a word with bits"),
    ("PG259", "read: [P18.1]", "P18 has 4 indexes{}: a bit belongs to one of them"),
    ("PG307", "read: ['P19[0..65534]']", "needs more than 255 telegrams{as FloatingPoint}"),
]  # fmt: skip


def told(folder: Path, grade: str, job: str) -> list[tuple[str, str, str]]:
    """Code, message and help of everything that a spec with one job brings, on a drive whose facts have one grade."""
    rows = "".join(f"  {key}: {row[:-1]}, grade: {grade}}}\n" for key, row in ROWS.items())
    (folder / "acme.yaml").write_text(
        "title: Acme\nsource: Acme manual\nrecord_index: {profibus: 47, default: profibus}\n"
        f"drive_object: {{default: 1}}\nparameters:\n{rows}",
        "utf-8",
    )
    spec = folder / "job.yaml"
    spec.write_text(
        "plc: {name: a, family: s7-300, toolchain: tia-v16}\n"
        "drives: {d: {device: ./acme.yaml, address: 256}}\n"
        + ("recipes: {r: {parameters: [P11], records: 2}}\n" if "recipe" in job else "")
        + f"jobs: {{j: {{drive: d, {job}}}}}\n",
        "utf-8",
    )
    return [(d.code, d.message, d.help) for d in api.check(spec).diagnostics]


@pytest.mark.parametrize("grade", WORDS)
@pytest.mark.parametrize(("code", "job", "message"), CASES, ids=[f"{code} {job}" for code, job, _ in CASES])
def test_a_message_says_how_the_fact_is_known(tmp_path: Path, code: str, job: str, message: str, grade: str) -> None:
    """Of what was read nothing is added; a conclusion and what is from memory are named where they decide."""
    shown = [(of, text) for of, text, _ in told(tmp_path, grade, job) if of == code]
    if code == "PG257" and grade == "recalled":
        assert "has not been looked up" in shown[0][1]
        return
    before, _, rest = message.partition("{")
    given, _, after = rest.partition("}")
    added = f" {given}{WORDS[grade]}" if given and WORDS[grade] else WORDS[grade]
    assert any(f"{before}{added}{after}" in text for _, text in shown), told(tmp_path, grade, job)


def test_a_name_that_nobody_has_read_is_no_value(tmp_path: Path) -> None:
    """It writes nothing, and the message gives the number and how it is known."""
    ((_, message, help_),) = [one for one in told(tmp_path, "inferred", "write: {P10: blue}") if one[0] == "PG211"]
    assert message == '"blue" is not a value of type Integer16 (inferred, not read in a manual)'
    assert help_.startswith("blue is 1 (inferred, not read in a manual): write the number")
    assert not [one for one in told(tmp_path, "read", "write: {P10: blue}") if one[0] == "PG211"]


@pytest.mark.parametrize("grade", WORDS)
def test_whoever_defines_a_parameter_has_looked_it_up(tmp_path: Path, grade: str) -> None:
    """What the spec says of a drive is never called inferred or from general knowledge."""
    told(tmp_path, grade, "read: [P10]")
    spec = tmp_path / "job.yaml"
    own = "{P10: {type: Integer16, access: rw, array: 2, max: 9}}"
    text = (
        spec.read_text("utf-8").replace("256}", f"256, parameters: {own}}}").replace("read: [P10]", "write: {P10: 10}")
    )
    spec.write_text(text, "utf-8")
    (message,) = [d.message for d in api.check(spec).diagnostics if d.code == "PG209"]
    assert message == "P10 = 10 is outside its limits ..9"


@pytest.mark.parametrize("device", ["sinamics-g120", "sinamics-v90"])
def test_what_cannot_be_written_is_told_once(tmp_path: Path, device: str) -> None:
    """Nobody is asked to classify a write that is refused anyway."""
    spec = tmp_path / "job.yaml"
    spec.write_text(
        "plc: {name: a, family: s7-300, toolchain: tia-v16}\n"
        f"drives: {{d: {{device: {device}, address: 256}}}}\n"
        "jobs: {j: {drive: d, write: {r722: 1}}}\n",
        "utf-8",
    )
    assert [d.code for d in api.check(spec).diagnostics if d.code in {"PG207", "PG261"}] == ["PG207"]

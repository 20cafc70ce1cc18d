"""Telegrams through Wireshark's dissector."""

from __future__ import annotations

from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.programs import find_program
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.proof import dissected
from plcgen.ds47.proof.dissected import FILL, TEXT, compare_dissection, dissected_checks, request_facts, response_facts
from plcgen.ds47.wire import codec, formats
from plcgen.ds47.wire.model import Response, ValueBlock
from plcgen.oracles import wireshark
from plcgen.oracles.documents import published
from plcgen.oracles.wireshark import WireRecord
from plcgen.project.opening import open_spec
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.folder import read_folder
from tests.projects import FAQ, SPECS, generated_example

PROGRAM = find_program("tshark") or ""
needs_tshark = pytest.mark.skipif(not PROGRAM, reason="tshark is not installed (apt install tshark)")


@needs_tshark
def test_published_telegrams() -> None:
    """Every field of every published telegram, as the codec reads it."""
    spoken = [WireRecord(0xB02F, one.request, one.answer) for one in published()]
    unknown: set[str] = set()
    for one, (request, answer) in zip(published(), wireshark.run_tshark(PROGRAM, spoken), strict=True):
        assert not compare_dissection("request", request_facts(codec.decode_request(one.request)), request, unknown), (
            one.id
        )
        assert not compare_dissection("answer", response_facts(codec.decode_response(one.answer)), answer, unknown), (
            one.id
        )
    assert not unknown


@needs_tshark
def test_every_format() -> None:
    """Wireshark agrees about each format that it knows; what it does not know is named."""
    blocks = [
        ValueBlock(fmt.code, count, bytes(range(1, 1 + count * fmt.size)))
        for fmt in formats.FORMATS
        if fmt.writable
        for count in (1, 2)
    ]
    request = bytes.fromhex("01 01 01 01 10 01 04 60 00 00")
    answers = [Response(1, 1, 1, 1, (block,)) for block in blocks]
    spoken = [WireRecord(0xB02F, request, codec.encode_response(answer)) for answer in answers]
    known = set()
    for answer, block, (_, shown) in zip(answers, blocks, wireshark.run_tshark(PROGRAM, spoken), strict=True):
        unknown: set[str] = set()
        assert not compare_dissection("answer", response_facts(answer), shown, unknown), formats.by_code(block.format)
        if not unknown - {FILL}:
            known.add(block.format)
    assert {*range(0x01, 0x09), 0x0A, 0x41, 0x42, 0x43} <= known
    assert formats.VISIBLE_STRING not in known


@needs_tshark
@pytest.mark.parametrize(
    ("record", "request_", "message"),
    [
        (0xB02D, "01 01 01 01 10 01 04 60 00 00", "sees no parameter request"),
        (0xB02F, "01 01 01 01 10 01 04 60 00 01", "field 8: index = 0 here, index = 1 in Wireshark"),
        (0xB02F, "01 01 01 01 20 01 04 60 00 00", "field 5: attribute = 16 here, attribute = 0x20 in Wireshark"),
        (0xB02F, "01 01 01 02 10 01 04 60 00 00 10 01 04 61 00 00", "field 4: no_of_parameters = 1 here"),
    ],
)
def test_a_difference_is_told(record: int, request_: str, message: str) -> None:
    """Field by field."""
    expected = request_facts(codec.decode_request(bytes.fromhex("01 01 01 01 10 01 04 60 00 00")))
    shown = wireshark.run_tshark(PROGRAM, [WireRecord(record, bytes.fromhex(request_), b"\1\1\1\0")])[0][0]
    assert message in compare_dissection("request", expected, shown, set())


def test_what_is_not_known_is_not_compared() -> None:
    """A text, and what follows the fill byte behind an odd number of bytes."""
    for block, reason in ((ValueBlock(0x05, 1, b"\7"), FILL), (ValueBlock(0x09, 2, b"ab"), TEXT)):
        fields = response_facts(Response(1, 1, 1, 2, (block, ValueBlock(0x06, 1, b"\0\5"))))
        assert ("stop", reason) in fields


def test_without_tshark_it_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """The check is listed, and fails nothing."""
    monkeypatch.setattr(dissected, "find_program", lambda _name: None)
    spec = next(path for path in SPECS if path.stem == "s7-300_6ra80_dp_tia")
    found = api.verify(spec, generated_example(spec.stem), faults="none", oracle="tshark")
    check = next(check for check in found.checks() if check.id == "wireshark")
    assert (check.outcome, check.verdict) == (Outcome.NOT_RUN, "not run: tshark is not installed")
    assert found.ok
    with pytest.raises(wireshark.WiresharkError, match="tshark failed"):
        wireshark.run_tshark("/no/tshark", [])


def agrees(checks: list[Check]) -> bool:
    """Whether Wireshark was asked, and said the same of everything."""
    asked = [check for check in checks if check.id.startswith("wireshark.")]
    return bool(asked) and all(check.outcome is Outcome.OK for check in asked)


@needs_tshark
@pytest.mark.slow
def test_verify_asks_wireshark() -> None:
    """Its checks are among those of verify."""
    found = api.verify(FAQ, generated_example(FAQ.stem), faults="none", oracle="tshark")
    assert found.ok
    assert agrees(list(found.checks()))


@needs_tshark
@pytest.mark.slow
@pytest.mark.parametrize("spec", [path for path in SPECS if "plant" not in path.stem], ids=lambda path: path.stem)
def test_every_shipped_spec(spec: Path) -> None:
    """Wireshark reads every telegram of the examples as it was meant."""
    project = open_spec(spec).sound()
    plan = project.plan(DrivePlan)
    if plan is not None:
        assert agrees(list(dissected_checks(plan, read_folder(generated_example(spec.stem), project.target))))

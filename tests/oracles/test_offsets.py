"""The second calculator of layouts: blocks that STEP 7 compiled, rules by hand, and a first one that is wrong."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from plcgen.oracles import offsets
from plcgen.oracles.offsets import NotKnownError, WrittenBlocks
from plcgen.project.opening import open_spec
from plcgen.proof import second_layout
from plcgen.proof.checks import Outcome
from plcgen.proof.folder import Folder, read_folder
from plcgen.s7.layout.layout import Layout
from tests.projects import FAQ, generated_example

RULES = {
    # 1 bit, next byte, even byte: 0.0, 0.1, 1.0, 2.0, 4.0 and an even length
    "a : BOOL; b : BOOL; c : BYTE; d : WORD; e : BYTE;": ({"a": 0, "b": 1, "c": 8, "d": 16, "e": 32}, 6),
    # a REAL at an even byte, not at a multiple of 4
    "a : BYTE; r : REAL; d : DWORD;": ({"a": 0, "r": 16, "d": 48}, 10),
    # a structure begins and ends even
    "a : BYTE; s : STRUCT b : BYTE; END_STRUCT; c : BYTE;": ({"a": 0, "s": 16, "s.b": 16, "c": 32}, 6),
    # 10 bits are two bytes; three bytes are padded to four
    "a : ARRAY[1..10] OF BOOL; b : BOOL;": ({"a": 0, "b": 16}, 4),
    "a : ARRAY[0..2] OF BYTE; b : BYTE;": ({"a": 0, "b": 32}, 6),
    # 2 + 3 characters, then the next byte; as elements 6 bytes each
    "s : STRING[3]; b : BYTE;": ({"s": 0, "b": 40}, 6),
    "a : ARRAY[1..2] OF STRING[3]; b : BYTE;": ({"a": 0, "b": 96}, 14),
    # rows of three bits: a byte each
    "a : ARRAY[1..2, 1..3] OF BOOL; b : BOOL;": ({"a": 0, "b": 16}, 4),
    'x, y : "other"; // a structure: STRUCT\n z : BYTE := 16#1;': (
        {"x": 0, "x.i": 0, "x.j": 16, "y": 32, "y.i": 32, "y.j": 48, "z": 64},
        10,
    ),
}
OTHER = 'TYPE "other"\nTITLE = a "free text\nVERSION : 0.1\nSTRUCT\ni : INT; j : BYTE;\nEND_STRUCT;\nEND_TYPE\n'


@pytest.mark.parametrize("members", RULES)
def test_the_rules_by_hand(members: str) -> None:
    """Places in bits and the length in bytes, worked out beside each declaration."""
    block = (
        f"DATA_BLOCK \"D\"\n{{ S7_Optimized_Access := 'FALSE' }}\nSTRUCT\n{members}\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK"
    )
    places, size = WrittenBlocks([OTHER + block]).places("d")
    assert ({place.path: place.bit for place in places}, size) == RULES[members]


@pytest.mark.parametrize(
    "source",
    [
        "TYPE a STRUCT b : ",
        "TYPE a STRUCT b : STRING[99999999]; END_STRUCT; END_TYPE",
        "TYPE a STRUCT b : ARRAY[x..y] OF INT; END_STRUCT; END_TYPE",
        "TYPE a STRUCT b : a; END_STRUCT; END_TYPE",
        "TYPE a STRUCT " + "b : STRUCT " * 5000,
        "TYPE a STRUCT b : " + "ARRAY[0..1] OF " * 5000 + "INT; END_STRUCT; END_TYPE",
        "TYPE a STRUCT b : LTIME; END_STRUCT; END_TYPE",
    ],
)
def test_what_it_does_not_know_it_says(source: str) -> None:
    """No member of such a source has a place; nothing else happens."""
    with pytest.raises(NotKnownError):
        WrittenBlocks([source]).places("a")


def test_it_shares_nothing_with_the_first() -> None:
    """No import of plcgen, and not more than a person can read."""
    lines = Path(offsets.__file__).read_text("utf-8").splitlines()
    assert not any("plcgen" in line for line in lines if line.startswith(("import", "from")))
    assert len(lines) <= 260


def faq_folder() -> Folder:
    """The FAQ's example as it lies on disk."""
    project = open_spec(FAQ).sound()
    return read_folder(generated_example(FAQ.stem), project.target)


def test_the_example_has_one_layout() -> None:
    """All members of all types and data blocks; the instance of the caller is left out."""
    (check,) = second_layout.check_second_layout(faq_folder())
    assert check.outcome is Outcome.OK
    assert check.text.endswith("types and data blocks; 1 left out: instances, types that it does not know")


def test_a_first_calculator_that_is_wrong_is_contradicted(monkeypatch: pytest.MonkeyPatch) -> None:
    """A rule that generator and verifier share, here the length of a block, is no rule for the second."""
    right = second_layout.layout_block

    def wrong(*given: object) -> Layout:
        found = right(*given)  # type: ignore[arg-type]
        return replace(found, size=found.size + 2)

    monkeypatch.setattr(second_layout, "layout_block", wrong)
    (check,) = second_layout.check_second_layout(faq_folder())
    assert check.diagnostic is not None
    assert check.diagnostic.code == "PG640"
    assert "for the second calculator" in check.diagnostic.message

"""The runner of broken facts, and a sample of them: what generate or verify must notice."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.diagnostics import Diagnostic, Severity
from tests.mutation.beliefs.__main__ import failures
from tests.mutation.beliefs.run import Outcome, tried
from tests.mutation.beliefs.tables import Break, breaks, names

FLOOR = 16
"""So many breaks of the sample there are at least, all of them noticed or with a reason why not."""


def test_every_break_is_in_its_file() -> None:
    """What a table replaces stands once in the file that it names, and no two breaks have one id."""
    found = list(breaks(names()))
    assert len({one.id for one in found}) == len(found)


def test_every_spec_of_the_tables_is_accepted(tmp_path: Path) -> None:
    """A spec that ``check`` refuses would notice everything; that it verifies is looked at before each run."""
    texts = dict.fromkeys(text for one in breaks(names()) for text in one.specs)
    refused = []
    for text in texts:
        (tmp_path / "spec.yaml").write_text(text, "utf-8")
        refused += [f"{text[:40]} {each.code} {each.message}" for each in _errors(tmp_path / "spec.yaml")]
    assert refused == []


def _errors(spec: Path) -> list[Diagnostic]:
    return [each for each in api.check(spec).diagnostics if each.severity is Severity.ERROR]


def test_a_table_that_is_out_of_date_fails() -> None:
    """A break whose text is gone, is there twice, or changes nothing, is an error and not a break that is noticed."""
    one = Break("a", "", "file", "old", "new", ())
    assert one.broken("an old text") == "an new text"
    for text, broken in (("a text", one), ("old old", one), ("old", replace(one, new="old"))):
        with pytest.raises(LookupError, match="file"):
            broken.broken(text)


def test_what_is_not_as_the_table_says_fails() -> None:
    """A break that nobody notices needs a reason, one that is noticed must not have one, and 95 % are noticed."""
    noticed, green = Outcome("noticed", "wrong value"), Outcome("green", "")
    one, argued = Break("a", "", "", "", "", ()), Break("b", "", "", "", "", (), reason="there is one source only")
    many = {replace(one, id=str(number)): noticed for number in range(19)}
    assert failures({**many, argued: green}) == []
    assert failures({**many, one: green}) == ["a: NOT NOTICED"]
    assert failures({one: noticed, argued: green}) == ["50.0 % is below 95 %"]
    assert failures({argued: noticed}) == ["b: noticed: wrong value; BUT THE TABLE SAYS WHY NOBODY NOTICES"]


@pytest.mark.slow
def test_a_spec_that_is_red_anyway_is_no_trial() -> None:
    """A spec that does not verify without a break would notice everything."""
    one = next(breaks(names()))
    with pytest.raises(ValueError, match="red without a break"):
        tried([replace(one, specs=("plc: {}",))], 1)


@pytest.mark.slow
def test_a_sample_of_broken_facts_is_noticed() -> None:
    """``make beliefs`` tries all of them."""
    sample = [one for one in breaks(names()) if one.sample]
    found = tried(sample, 1)
    assert [f"{one.id}: {one.what}" for one, how in found.items() if not how.noticed and not one.reason] == []
    assert sum(how.noticed for how in found.values()) >= FLOOR

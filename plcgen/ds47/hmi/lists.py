"""The text lists of drive jobs: what ``status``, ``errors``, ``recordStatus`` mean, and fault classes of PROFIdrive.

English stands where the blocks have it (``words.py``, ``error_numbers.toml``); ``texts.toml`` has the other languages.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from plcgen.build.text_lists import TextEntry, TextList
from plcgen.ds47.messages import all_messages
from plcgen.ds47.plan.nouns import DriveJob
from plcgen.ds47.wire.errors import Table, error_text, known_numbers
from plcgen.ds47.wire.formats import FORMATS, OLDER
from plcgen.ds47.wire.status import explain_word, known_words
from plcgen.ds47.words import STATUS_WORDS

LANGUAGES = ("en", "de", "zh")
"""Languages with a text for everything."""
_ANSWERED, _CAME = 0x8000, 0x8100
_BUFFERS = {"DriveFaults": "F", "DriveAlarms": "A"}
"""Lists for the numbers of a buffer (r945, r2122), and the kind of message that it holds."""
_NUMBERS = {945: "DriveFaults", 2122: "DriveAlarms"}
_MEMBERS = {
    "status": "DriveJobStatus", "recordStatus": "DriveRecordStatus", "errors": "DriveJobErrors",
    "valueFormat": "DriveValueFormats", "writeFormat": "DriveValueFormats",
}  # fmt: skip
_DIAGNOSIS = 0x9000
"""First fault class in the channel diagnosis of PROFINET."""


@cache
def translations() -> Mapping[str, Any]:
    """``texts.toml`` with numbers as keys."""
    tables = tomllib.loads(Path(__file__).with_name("texts.toml").read_text("utf-8"))
    return {name: table if name == "came" else {int(key, 0): row for key, row in table.items()}
            for name, table in tables.items()}  # fmt: skip


def text_lists(cultures: Sequence[str], errors: Table = "sinamics", families: Sequence[str] = ()) -> list[TextList]:
    """The five lists, in these cultures; one of a language without texts has the English ones.

    ``errors`` is the table of error numbers that the device has; with the ``families`` of its messages come two lists
    more, DriveFaults and DriveAlarms, whose titles are in English alone.
    """
    return [
        _list("DriveJobStatus", cultures, _status()),
        _list("DriveJobErrors", cultures, _errors(errors)),
        _list("DriveRecordStatus", cultures, _record()),
        _list("DriveFaultClasses", cultures, _classes()),
        _list("DriveValueFormats", cultures, _formats()),
        *(_list(name, cultures, _messages(kind, families)) for name, kind in _BUFFERS.items() if families),
    ]


def list_of(job: DriveJob, path: Sequence[str]) -> str:
    """The list for a member of a job in its data block, without indexes; "" for none.

    Numbers of a buffer have one if the messages of the device are known.
    """
    found = _MEMBERS.get(path[-1], "")
    for use in job.uses if job.drive.device.messages else ():
        delivered = [job.messages.member, "code"] if job.messages else [use.member]
        if [*path] == delivered:
            found = _NUMBERS.get(use.parameter.pnu, found)
    return found


def _list(name: str, cultures: Sequence[str], rows: Iterator[tuple[int, Mapping[str, str]]]) -> TextList:
    entries = [
        TextEntry(value, {culture: texts.get(culture[:2].lower(), texts["en"]) for culture in cultures})
        for value, texts in rows
    ]
    return TextList(name, sorted(entries, key=lambda entry: entry.value))


def _messages(kind: str, families: Sequence[str]) -> Iterator[tuple[int, Mapping[str, str]]]:
    """What a number in a buffer stands for; where families or kinds of a device differ, each title."""
    titles: dict[int, dict[str, None]] = {}
    for one in all_messages(families):
        if kind in {one.kind, *one.also}:
            titles.setdefault(one.number, {})[one.title] = None
    for number, each in titles.items():
        yield number, {"en": f"{kind}{number:05} {' / '.join(each)}"}


def _status() -> Iterator[tuple[int, Mapping[str, str]]]:
    for _, word, text in STATUS_WORDS:
        yield word, {"en": text, **translations()["status"][word]}


def _errors(table: Table) -> Iterator[tuple[int, Mapping[str, str]]]:
    """What an element of ``errors`` may be, docs/generated-code.md."""
    known = translations()
    yield from known["result"].items()
    for number in known_numbers():
        found = error_text(number, table)
        if table == "sinamics" or found.origin.startswith("PROFIdrive"):
            yield _ANSWERED | number, {"en": found.meaning, **known["error"][number]}
    for one in FORMATS:
        yield _CAME | one.code, {language: text.format(type=one.name) for language, text in known["came"].items()}


def _record() -> Iterator[tuple[int, Mapping[str, str]]]:
    """What ``recordStatus`` may be: bytes 2 and 3 of STATUS of a record job that has ended."""
    known = translations()
    texts: Mapping[str, str] = {}
    yield 0, known["result"][0]
    for word in known_words():
        texts = known["record"].get(word, texts)
        yield word, {"en": explain_word(word).text, **texts}


def _formats() -> Iterator[tuple[int, Mapping[str, str]]]:
    """What ``valueFormat`` and ``writeFormat`` of a service may be: the names of types, the same in every language."""
    yield from translations()["format"].items()
    yield from ((one.code, {"en": one.name}) for one in (*FORMATS, *OLDER) if one.writable)


def _classes() -> Iterator[tuple[int, Mapping[str, str]]]:
    for number, texts in translations()["fault_class"].items():
        yield number, texts
        yield _DIAGNOSIS + number - 1, texts

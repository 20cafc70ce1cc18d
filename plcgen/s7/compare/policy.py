"""What every kind of change means to others: the one table of change ids, and how a user overrides it."""

from __future__ import annotations

import enum
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, RootModel

from plcgen.base.diagnostics import Report, Span
from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.base.files.text import read_text
from plcgen.base.files.validation import FileShape, problem, read_document, validate
from plcgen.base.files.yaml import plain_node


class Level(enum.StrEnum):
    """Who notices: other programs and the HMI, nobody but the block itself, readers of comments only."""

    BREAKING = "breaking"
    COMPATIBLE = "compatible"
    DOCUMENTATION = "documentation"

    @property
    def rank(self) -> int:
        """0 for the worst."""
        return list(Level).index(self)


@dataclass(frozen=True, slots=True)
class ChangeKind:
    """One kind of change: stable id, default level, what it is, why it is so classified."""

    id: str
    level: Level
    title: str
    why: str


_B, _C, _D = Level.BREAKING, Level.COMPATIBLE, Level.DOCUMENTATION
_TABLE = (
    ChangeKind("block-added", _C, "block added", "nothing refers to it yet"),
    ChangeKind("block-removed", _B, "block removed", "calls, the HMI and other PLCs still refer to it"),
    ChangeKind("block-renamed", _B, "block renamed", "symbolic references break"),
    ChangeKind(
        "block-renumbered", _B, "block number changed", "absolute references (DB3.DBW6, PUT/GET) reach another block"
    ),
    ChangeKind("block-grown", _C, "block became longer", "what was there stays where it was, unless members moved"),
    ChangeKind("block-shrunk", _B, "block became shorter", "reads of the old length reach beyond the end of the block"),
    ChangeKind("access-changed", _B, "optimized and standard access exchanged", "offsets appear or vanish"),
    ChangeKind("instance-type", _B, "instance or type-based DB made from another type", "its whole contents change"),
    ChangeKind(
        "block-attribute", _C, "attribute of the block changed", "start-up or protection may differ, the layout not"
    ),
    ChangeKind("block-text", _D, "title, author, version or comment of the block", "nothing but text changes"),
    ChangeKind("member-added", _C, "member added", "what follows may move: that is reported separately"),
    ChangeKind(
        "parameter-required", _B, "parameter that every call must supply was added", "existing calls do not compile"
    ),
    ChangeKind("member-removed", _B, "member removed", "readers find nothing or something else"),
    ChangeKind(
        "member-renamed", _B, "member renamed, at the same place", "symbolic references break, absolute ones do not"
    ),
    ChangeKind(
        "member-spelling",
        _D,
        "letter case of a name",
        "S7 names are not case-sensitive, OPC UA clients are: breaking there",
    ),
    ChangeKind(
        "member-reordered",
        _C,
        "order of members with optimized access",
        "the next download sets the block to start values",
    ),
    ChangeKind("member-moved", _B, "member lies at another offset", "absolute readers and the drive read other bytes"),
    ChangeKind("section-changed", _B, "parameter changed its section", "calls pass it in another direction"),
    ChangeKind("type-changed", _B, "data type changed", "the same bytes mean something else"),
    ChangeKind(
        "length-changed", _B, "length of a string or array changed", "readers expect the old number of elements"
    ),
    ChangeKind("start-value", _C, "start value changed", "takes effect when the block is loaded or initialised"),
    ChangeKind("constant-changed", _C, "constant changed", "the block behaves differently, its interface not"),
    ChangeKind("retain-changed", _C, "retentivity changed", "the value survives a restart, or no longer does"),
    ChangeKind(
        "hmi-access-removed", _B, "no longer visible, readable or writable from outside", "HMI and OPC UA lose it"
    ),
    ChangeKind("hmi-access-added", _C, "now visible, readable or writable from outside", "nothing is lost"),
    ChangeKind("member-attribute", _C, "other attribute of a member", "the layout stays"),
    ChangeKind("member-comment", _D, "comment of a member", "nothing but text changes"),
    ChangeKind("internal-changed", _C, "static variables of an FB changed", "not for use from outside: style guide"),
    ChangeKind(
        "internal-moved", _C, "static variables of an FB moved", "instance data are initialised again when loaded"
    ),
    ChangeKind("local-changed", _C, "temporary variables or constants declared differently", "invisible from outside"),
    ChangeKind("code-changed", _C, "code changed", "the block behaves differently, its interface not"),
    ChangeKind("tag-address", _B, "address of a tag changed", "what reads or wires the old address no longer meets it"),
    ChangeKind("job-added", _C, "job added", "nothing refers to it yet"),
    ChangeKind("job-removed", _B, "job removed", "its block and its data go away"),
    ChangeKind("telegram-count", _B, "job is sent in another number of telegrams", "buffers and timing differ"),
    ChangeKind("telegram-field", _B, "request asks for something else", "another parameter, index, axis or service"),
    ChangeKind("telegram-value", _C, "request writes another value", "intended, but worth a look: the drive gets it"),
    ChangeKind("telegram-reference", _C, "other request reference at start", "the block changes it with every request"),
    ChangeKind("request-length", _B, "request has another length", "LEN of WRREC and the buffer change"),
    ChangeKind("response-length", _B, "answer or its buffer has another length", "MLEN of RDREC and the buffer change"),
    ChangeKind("drive-added", _C, "drive added", "nothing refers to it yet"),
    ChangeKind("drive-removed", _B, "drive removed", "its jobs go away"),
    ChangeKind("drive-address", _B, "hardware identifier or address changed", "requests go to another device"),
    ChangeKind(
        "drive-device", _B, "device, drive object or record index changed", "the drive is addressed differently"
    ),
    ChangeKind("job-drive", _B, "job works on another drive", "requests go to another device"),
    ChangeKind("job-timing", _C, "timeout, pauses or retries changed", "jobs end earlier or later"),
    ChangeKind(
        "job-trigger",
        _B,
        "absolute flags of a job changed",
        "what sets or reads the old flags no longer has any effect",
    ),
)
KINDS: Mapping[str, ChangeKind] = MappingProxyType({kind.id: kind for kind in _TABLE})
"""Every kind of change by id, in the order of the documentation."""

FAIL_ON = ("breaking", "compatible", "any", "never")
"""What ``--fail-on`` knows; ``any`` includes documentation."""


def fails(level: Level, fail_on: str) -> bool:
    """Whether a change of this level fails a run with this ``--fail-on``."""
    if fail_on == "never":
        return False
    return fail_on == "any" or level.rank <= Level(fail_on).rank


def _kind(key: str) -> str:
    if key not in KINDS:
        hint = did_you_mean(key, KINDS) or "plcgen diff --list-changes shows all of them"
        raise problem(f'there is no kind of change "{key}"', code="PG631", help_=hint)
    return key


def _level(word: object) -> Level:
    try:
        return Level(str(word).strip().lower())
    except ValueError:
        shown = f'"{word}"' if isinstance(word, str | int | float) else "this"
        help_ = "one of breaking, compatible, documentation"
        raise problem(f"{shown} is not a class of change", code="PG631", help_=help_) from None


class Policy(RootModel[dict[Annotated[str, AfterValidator(_kind)], Annotated[Level, BeforeValidator(_level)]]]):
    """A policy file."""


POLICY = FileShape(
    Policy, "the policy", "a policy is a mapping of change ids to classes", "for example: member-renamed: compatible"
)


def load_policy(settings: Iterable[str]) -> dict[str, Level]:
    """Levels by change id: the defaults, then every setting in order, ``id=level`` or the path of a YAML file.

    Raises:
        DiagnosticError: PG631 for an unknown id or level, and the codes of reading YAML.
    """
    policy = {kind.id: kind.level for kind in KINDS.values()}
    report = Report()
    for setting in settings:
        policy |= _read(setting, report)
    report.raise_on_errors()
    return policy


def _read(setting: str, report: Report) -> dict[str, Level]:
    key, separator, value = setting.partition("=")
    if separator:
        typed = validate(plain_node({key.strip(): value.strip()}, Span(f"--policy {setting}")), POLICY, report)
        return typed.root if typed else {}
    path = Path(setting)
    with report.catch():
        loaded = read_document(read_text(path), path.as_posix(), POLICY, report)
        if loaded:
            return loaded.model.root
    return {}

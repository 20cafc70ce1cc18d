"""Declared interfaces of the system function blocks, by target: what a call may name and where it lies."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType

from plcgen.s7.types.blocks import Block, BlockKind, Section, SectionKind
from plcgen.s7.types.data_types import Member, NamedType, elementary
from plcgen.s7.types.system import CONTROL, s7_1500_types, serial_blocks, system_block

_IN, _OUT, _STATIC = SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.STATIC

_NUMBERS = {
    "SFB0": "CTU", "SFB1": "CTD", "SFB2": "CTUD", "SFB3": "TP", "SFB4": "TON", "SFB5": "TOF",
    "SFB52": "RDREC", "SFB53": "WRREC",
}  # fmt: skip
_SERIAL = frozenset({*serial_blocks(classic=True), *serial_blocks(classic=False)})
TIMERS = ("", "TON", "TOF", "TP", "TONR")
"""IEC timers; those of the S7-1200/1500 keep in their data as which of them they were called."""
_TIMER_PARAMETERS = {"IN": _IN, "PT": _IN, "Q": _OUT, "ET": _OUT}
_CLASSIC_TIMER = ("IN BOOL;PT TIME", "Q BOOL;ET TIME", "STATE BYTE;STIME TIME;ATIME TIME")
_TRIGGER = ("CLK BOOL", "Q BOOL", "STAT_BIT BOOL")


def _counters(type_: str, down: str) -> dict[str, tuple[str, str, str]]:
    return {
        "CTU": (f"CU BOOL;R BOOL;PV {type_}", f"Q BOOL;CV {type_}", "CUO BOOL"),
        "CTD": (f"CD BOOL;{down} BOOL;PV {type_}", f"Q BOOL;CV {type_}", "CDO BOOL"),
        "CTUD": (
            f"CU BOOL;CD BOOL;R BOOL;{down} BOOL;PV {type_}",
            f"QU BOOL;QD BOOL;CV {type_}",
            "CUO BOOL;CDO BOOL",
        ),
    }


@dataclass(frozen=True, slots=True)
class SystemFb:
    """A system function block: ``kind`` says how it behaves, ``parameters`` what a call may name."""

    kind: str
    block: Block
    parameters: Mapping[str, SectionKind]

    @property
    def record(self) -> bool:
        """Whether a data record is a parameter."""
        return self.kind in {"WRREC", "RDREC"}

    @property
    def takes_over(self) -> bool:
        """Whether it is a timer of the S7-1200/1500, whose PT counts at an edge of IN only."""
        return self.kind in TIMERS and any(m.name == "RESERVED" for s in self.block.sections for m in s.members)

    @property
    def watched(self) -> bool:
        """Whether STATUS counts in the scan of the call only."""
        return self.record or self.kind in _SERIAL

    @property
    def buffer(self) -> str:
        """Name of the parameter that is passed by reference; empty if there is none."""
        names = ("RECORD", "BUFFER", "RECEIVE_CONDITIONS")
        return next((name for name in names if name in self.parameters), "")


@cache
def system_fbs(*, classic: bool) -> Mapping[str, SystemFb]:
    """Every system function block of a target by upper-case name, numbers such as SFB53 included."""
    found: dict[str, SystemFb] = {}
    sections = _counters("INT", "LOAD" if classic else "LD") | {"R_TRIG": _TRIGGER, "F_TRIG": _TRIGGER}
    if classic:
        sections |= dict.fromkeys(("TON", "TOF", "TP"), _CLASSIC_TIMER)
    else:
        for type_ in ("SINT", "INT", "DINT", "USINT", "UINT", "UDINT"):
            for name, parts in _counters(type_, "LD").items():
                sections[f"{name}_{type_}"] = parts
    for name, parts in sections.items():
        block = _block(name, parts)
        kind = name.partition("_")[0] if name.startswith("CT") else name
        found[name] = SystemFb(kind, block, _parameters(block))
    for name in CONTROL:
        controlling = system_block(name)
        if controlling is not None:
            found[name] = SystemFb(name, controlling, _parameters(controlling))
    modern = s7_1500_types()
    for name in ("WRREC", "RDREC"):
        record = system_block(name) if classic else modern[name]
        if record is not None:
            found[name] = SystemFb(name, record, _parameters(record))
    for name, block in serial_blocks(classic=classic).items():
        found[name] = SystemFb(name, block, _parameters(block))
    if not classic:
        for kind in TIMERS[1:]:
            reset = {"R": _IN} if kind == "TONR" else {}
            for name in (kind, f"{kind}_TIME", f"{kind}_LTIME"):
                timer = system_block(name)
                if timer is not None:
                    found[name] = SystemFb(kind, timer, MappingProxyType(_TIMER_PARAMETERS | reset))
    else:
        found |= {number: found[name] for number, name in _NUMBERS.items() if name in found}
    return MappingProxyType(found)


def _block(name: str, parts: tuple[str, str, str]) -> Block:
    kinds = (_IN, _OUT, _STATIC)
    return Block(
        BlockKind.FB, name, tuple(Section(kind, _members(text)) for kind, text in zip(kinds, parts, strict=True))
    )


def _members(text: str) -> tuple[Member, ...]:
    pairs = (part.split() for part in text.split(";"))
    return tuple(Member(name, elementary(type_) or NamedType(type_)) for name, type_ in pairs)


def _parameters(block: Block) -> Mapping[str, SectionKind]:
    return MappingProxyType(
        {m.name.upper(): s.kind for s in block.sections for m in s.members if s.kind is not _STATIC}
    )

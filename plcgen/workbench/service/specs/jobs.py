"""Which jobs a drive or a station can have, and why it cannot have the others: as the rules of a spec say it.

Every kind is tried: a spec of this drive alone gets a job of each, and what ``check`` finds wrong is the reason. So no
table of abilities can disagree with the rules.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from plcgen.base.diagnostics import Diagnostic, Severity
from plcgen.base.files.yaml import load_yaml
from plcgen.ds47.registry import kinds
from plcgen.workbench.service.specs.drives import known_drive
from plcgen.workbench.starter import KINDS, STAND_INS, sampled, samples

if TYPE_CHECKING:
    from plcgen.ds47.device import Device
    from plcgen.ds47.kind import JobKind
    from plcgen.workbench.service.specs.state import SpecState

RECIPE = "material"
RECIPE_BODY = "{parameters: [P], records: 2}"
"""Its values are for the program or a panel to set: nobody has said any."""
_MORE = {
    "read": ("read: [R]", "values of the drive"),
    "write": ("write: {P: }", "inputs of the block, or constants"),
}
_OTHER_WAYS = {"save": ("save: unit",)}
_STATION = {
    "read": ("read: [VW100]", "values of the station"),
    "write": ("write: {VW200: }", "inputs of the block, or constants"),
    "run": ("run: true", "sets the CPU to RUN"),
    "stop": ("stop: true", "sets the CPU to STOP"),
}
_PARAMETER = re.compile(r"\b(?:[RPW]|VW[0-9]+)\b")
_TYPES = {"R": "FloatingPoint", "P": "FloatingPoint", "W": "Unsigned16"}


@dataclass(frozen=True, slots=True)
class JobOffer:
    """A kind of job for a drive or a station: ``text`` are its keys in a line of YAML, beside the partner.

    ``lacks`` says why this partner cannot have it, ``help`` what may be done about it, ``code`` which rule it is; empty
    if it can. ``cycle``: whether it may run in a cycle. ``asks``: the device is known to have no parameter that
    fits; its number is to be given, for R, P or W in the text or for the recipe that is made. ``parameter``: the one in
    the text, or the address of a station, which may be another one; None if the kind has none.
    """

    kind: str
    title: str
    text: str
    lacks: str = ""
    help: str = ""
    code: str = ""
    cycle: bool = False
    asks: bool = False
    parameter: str | None = None


def job_offers(state: SpecState, partner: str) -> tuple[JobOffer, ...]:
    """The kinds of jobs of a drive, of several (``a,b``) or of a station given as ``line/station``.

    None while the text is broken.
    """
    if "," in partner:
        keys = partner.split(",")
        each = [job_offers(state, key) for key in keys]
        return tuple(_of_all(keys, same) for same in zip(*each, strict=True)) if all(each) else ()
    data: Any = None if state.composed is None else state.composed.root.data()
    if not isinstance(data, dict):
        return ()
    line, slash, station = partner.partition("/")
    if slash:
        cut = {"plc": data.get("plc"), "ppi": {line: (data.get("ppi") or {}).get(line)}}
        return _tried(json.dumps(cut), state.document.path, (line, station), None)
    known = known_drive(state, partner)
    if known is None:
        return ()
    cut = {"plc": data.get("plc"), **_alone(data, partner)}
    return _tried(json.dumps(cut), state.document.path, (partner,), _Same(known.device))


def _of_all(keys: Sequence[str], same: Sequence[JobOffer]) -> JobOffer:
    """A kind for several drives: what one of them lacks, a job with all of them cannot have."""
    lacking = [replace(one, lacks=f"{key}: {one.lacks}") for key, one in zip(keys, same, strict=True) if one.lacks]
    whole = replace(same[0], cycle=all(one.cycle for one in same), asks=any(one.asks for one in same))
    return lacking[0] if lacking else whole


def _alone(data: Mapping[str, Any], key: str) -> dict[str, Any]:
    """A drive, with its unit if it has one, without the rest of the plant."""
    units = data.get("units") or {}
    home = next((name for name, unit in units.items() if key in ((unit or {}).get("drives") or {})), None)
    return {"drives": {key: (data.get("drives") or {}).get(key)}} if home is None else {"units": {home: units[home]}}


@dataclass(frozen=True, slots=True, eq=False)
class _Same:
    """A device that is the same only if it is the same object: a profile on disk may have become another one."""

    device: Device

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and other.device is self.device

    def __hash__(self) -> int:
        return id(self.device)


@lru_cache(maxsize=64)
def _tried(text: str, path: Path, partner: tuple[str, ...], same: _Same | None) -> tuple[JobOffer, ...]:
    """Every kind, tried; what all of them have in common is wrong with the partner, and no reason."""
    trial = _Trial(text, path, partner, {} if same is None else samples(same.device))
    forms = _STATION_FORMS if same is None else drive_forms()
    trial.common = frozenset.intersection(*(frozenset(map(_said, trial.errors(form.texts[0]))) for form in forms))
    return tuple(trial.offer(form) for form in forms)


@dataclass(slots=True)
class _Trial:
    """A spec without jobs, to which one at a time is added; ``known`` are parameters by letter."""

    base: str
    path: Path
    partner: tuple[str, ...]
    known: Mapping[str, str]
    common: frozenset[tuple[str, str]] = frozenset()

    def offer(self, form: JobForm) -> JobOffer:
        """What a kind is for this partner: in the first form that it takes, else in the usual one."""
        found = None
        for text in form.texts:
            keys = sampled(text, self.known)
            shown = f"{keys} {sampled(RECIPE_BODY, self.known)}" if f": {RECIPE}" in keys else keys
            asks = sampled(shown, STAND_INS) != shown
            letter = _PARAMETER.search(RECIPE_BODY if f": {RECIPE}" in keys else text)
            parameter = letter and (letter[0] if len(letter[0]) > 1 else self.known.get(letter[0], ""))
            wrong = self.wrong(text)
            if wrong is None:
                cycle = form.repeats and self.wrong(f"{text}, cycle: 1s") is None
                return JobOffer(form.kind, form.title, keys, cycle=cycle, asks=asks, parameter=parameter)
            found = found or JobOffer(
                form.kind, form.title, keys, wrong.message, wrong.help, wrong.code, asks=asks, parameter=parameter
            )
        assert found is not None  # every form has a text
        return found

    def wrong(self, text: str) -> Diagnostic | None:
        """What is wrong with a job, and not with every other one."""
        return next((one for one in self.errors(text) if _said(one) not in self.common), None)

    def errors(self, text: str) -> list[Diagnostic]:
        """Everything that is wrong with the spec while it has a job."""
        from plcgen import api

        numbers = {**STAND_INS, **self.known}
        job = load_yaml(f"{{{sampled(text, numbers)}}}", "").data()
        data = json.loads(self.base)
        if len(self.partner) > 1:
            line, station = self.partner
            data["ppi"][line] = {**(data["ppi"][line] or {}), "jobs": {"job": {"station": station, **job}}}
        else:
            data["jobs"] = {"job": {"drive": self.partner[0], **job}}
            if f": {RECIPE}" in text:
                data["recipes"] = {RECIPE: load_yaml(sampled(RECIPE_BODY, numbers), "").data()}
            self.define(data)
        whole = json.dumps(data)
        checked = api.check(self.path, read=lambda *_: whole)
        return [one for one in checked.diagnostics if one.severity is Severity.ERROR]

    def define(self, data: dict[str, Any]) -> None:
        """Give the drive the parameters that stand in for those it is not known to have."""
        key = self.partner[0]
        homes = [data.get("drives"), *((unit or {}).get("drives") for unit in (data.get("units") or {}).values())]
        for drive in (home[key] for home in homes if home and isinstance(home.get(key), dict)):
            missing = {letter: type_ for letter, type_ in _TYPES.items() if letter not in self.known}
            own = {STAND_INS[letter]: {"type": type_} for letter, type_ in missing.items()}
            drive["parameters"] = {**own, **(drive.get("parameters") or {})}


def _said(one: Diagnostic) -> tuple[str, str]:
    return one.code, one.message


@dataclass(frozen=True, slots=True)
class JobForm:
    """How a kind of job is begun: its texts, one line of YAML each, of which the first is the usual one."""

    kind: str
    title: str
    texts: tuple[str, ...]
    repeats: bool = True


_STATION_FORMS = tuple(JobForm(kind, title, (text,)) for kind, (text, title) in _STATION.items())


@cache
def drive_forms() -> tuple[JobForm, ...]:
    """Those of the starter, and one for each kind besides, as its example has it."""
    known = {kind.key: kind for kind in kinds()}
    written = dict(_MORE)
    for name, lines in KINDS.items():
        parts = [line.partition(" | ") for line in lines.split("\n")]
        written["write_recipe" if name == "recipe" else name] = (
            ", ".join(body for body, _, _ in parts),
            next((said for _, _, said in parts if said), ""),
        )
    used = {text.partition(":")[0] for text, _ in written.values()}
    written |= {key: (kind.example, kind.description) for key, kind in known.items() if key not in used}
    return tuple(_form(name, text, said, known[text.partition(":")[0]]) for name, (text, said) in written.items())


def _form(name: str, text: str, said: str, kind: JobKind) -> JobForm:
    texts = (f"{kind.key}: {RECIPE}",) if kind.recorded else (text, *_OTHER_WAYS.get(name, ()))
    return JobForm(name, said or kind.description, texts, kind.repeatable)

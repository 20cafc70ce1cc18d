"""The JSON schema of everything that ``--format json`` writes, by the ``kind`` that each result says.

The shapes are stated by hand: what a program may rely on. Keys beyond them are a mistake of ours, and the tests look at
every result that they make.
"""

from __future__ import annotations

from typing import Any

from plcgen.base.diagnostics import Severity
from plcgen.base.display.data import FORMAT
from plcgen.build.sheet import Role
from plcgen.proof.checks import Outcome
from plcgen.proof.ledger import Grade
from plcgen.s7.compare.policy import Level

Shape = dict[str, Any]

TEXT: Shape = {"type": "string"}
NUMBER: Shape = {"type": "integer", "minimum": 0}
FLAG: Shape = {"type": "boolean"}
ANYTHING: Shape = {}


def said(text: str, shape: Shape) -> Shape:
    """A shape with a sentence about it."""
    return {**shape, "description": text}


def one_of(*words: str) -> Shape:
    """One of some words."""
    return {"enum": list(words)}


def many(shape: Shape) -> Shape:
    """A list."""
    return {"type": "array", "items": shape}


def _table(shape: Shape) -> Shape:
    """Values by names that the user has chosen."""
    return {"type": "object", "additionalProperties": shape}


def maybe(shape: Shape) -> Shape:
    """Or null."""
    return {"anyOf": [shape, {"type": "null"}]}


def record(optional: dict[str, Shape] | None = None, /, **keys: Shape) -> Shape:
    """An object with these keys and no others; those of ``optional`` may be missing."""
    keys = {name.rstrip("_"): shape for name, shape in keys.items()}
    return {
        "type": "object",
        "properties": {**keys, **(optional or {})},
        "required": list(keys),
        "additionalProperties": False,
    }


def hexadecimal(digits: int | None = None) -> Shape:
    """Bytes or a word as hexadecimal digits."""
    return {"type": "string", "pattern": "^[0-9A-F]*$" if digits is None else f"^[0-9A-F]{{{digits}}}$"}


SHA256: Shape = {"type": "string", "pattern": "^([0-9a-f]{64})?$"}
_LINES = {name: {"type": "integer", "minimum": 1} for name in ("line", "column", "end_line", "end_column")}
PLACE = record(_LINES, file=TEXT)
NOTE = record(_LINES, message=TEXT, file=TEXT)
DIAGNOSTIC = said(
    "A problem: lines and columns count from 1, and are left out for a file as a whole.",
    record(
        _LINES,
        code=said("Stable; docs/codes explains each.", {"type": "string", "pattern": "^PG[0-9]{3}$"}),
        severity=one_of(*(severity.label for severity in Severity)),
        message=TEXT,
        file=TEXT,
        help=said("What to do about it; may be empty.", TEXT),
        notes=many({"$ref": "#/$defs/note"}),
    ),
)
DIAGNOSTICS = many({"$ref": "#/$defs/diagnostic"})
COUNTS = record(errors=NUMBER, warnings=NUMBER, notes=NUMBER)
FOUND = {"summary": COUNTS, "diagnostics": DIAGNOSTICS}

FIELD = record(offset=NUMBER, length=NUMBER, hex=hexadecimal(), name=TEXT, value=TEXT, meaning=TEXT, problem=FLAG)
_TELEGRAM = {
    "kind": TEXT,
    "ok": FLAG,
    "hex": hexadecimal(),
    "length": NUMBER,
    "fields": many({"$ref": "#/$defs/field"}),
}
TELEGRAM = record(**_TELEGRAM, problems=many(record(offset=NUMBER, message=TEXT)))
_VIOLATION = record(kind=TEXT, offset=NUMBER, message=TEXT)
FRAME = record(**_TELEGRAM, problems=many(_VIOLATION), tolerated=many(_VIOLATION), offset=NUMBER, text=TEXT)

_SIZE = record(
    lines=NUMBER, fbs=NUMBER, fcs=NUMBER, obs=NUMBER, dbs=NUMBER, code=maybe(NUMBER), data=NUMBER, total=maybe(NUMBER),
    cpu=maybe(record(name=TEXT, percent=maybe(NUMBER))), idle_statements=maybe(NUMBER),
)  # fmt: skip
_WRITTEN = {
    "folder": TEXT, "written": many(TEXT), "unchanged": many(TEXT), "removed": many(TEXT),
    "diff": TEXT, "size": maybe(_SIZE),
}  # fmt: skip

CHECK = record(
    id=TEXT, subject=TEXT, text=TEXT, outcome=one_of(*(outcome.value for outcome in Outcome)), verdict=TEXT,
    diagnostic=maybe({"$ref": "#/$defs/diagnostic"}),
)  # fmt: skip
VERIFICATION = {
    "spec": TEXT, "folder": TEXT, "project": TEXT, "target": TEXT,
    "summary": said("How many checks had which outcome.", _table(NUMBER)),
    "groups": many(record(name=TEXT, title=TEXT, checks=many(CHECK))),
    "ledger": said(
        "What the result rests on.",
        many(record(subject=TEXT, text=TEXT, source=TEXT, grade=one_of(*(grade.value for grade in Grade)))),
    ),
    "diagnostics": DIAGNOSTICS,
}  # fmt: skip

_MEMBER = record(
    name=TEXT, path=TEXT, byte=maybe(NUMBER), bit=maybe(NUMBER), bits=maybe(NUMBER), address=TEXT, type=TEXT,
    start=TEXT, depth=NUMBER, comment=TEXT, role=TEXT, kind=TEXT, unconfirmed=many(TEXT),
)  # fmt: skip
LAYOUT = {
    "blocks": many(
        record(
            kind=TEXT, name=TEXT, number=maybe(NUMBER), size=maybe(NUMBER), unused_bits=NUMBER, optimized=FLAG,
            role=TEXT, comment=TEXT, file=TEXT, line=NUMBER, data=maybe(hexadecimal()), members=many(_MEMBER),
            unconfirmed_rules=_table(TEXT),
        )
    ),
    "diagnostics": DIAGNOSTICS,
}  # fmt: skip
_LEVEL = one_of(*(level.value for level in Level))
COMPARISON = {
    "old": TEXT, "new": TEXT, "fail_on": TEXT, "summary": _table(NUMBER),
    "sentences": many(record(job=TEXT, level=_LEVEL, text=TEXT, partners=many(TEXT), place=maybe(PLACE))),
    "changes": many(
        record(
            id=TEXT, level=_LEVEL, subject=TEXT, path=TEXT, message=TEXT, old=TEXT, new=TEXT,
            old_place=maybe(PLACE), new_place=maybe(PLACE), details=many(TEXT),
        )
    ),
    "diagnostics": DIAGNOSTICS,
}  # fmt: skip

_VALUE = said("What a member holds; a text where JSON has no such number.", ANYTHING)
_SIGNAL = record(
    id=TEXT, group=TEXT, name=TEXT, kind=one_of("bool", "integer", "word", "real", "text"), bits=NUMBER, unit=TEXT,
    path=TEXT, names=_table(TEXT), start=_VALUE,
)  # fmt: skip
_CALL = record(
    dict.fromkeys(("done", "valid", "ndr"), FLAG),
    group=TEXT, block=TEXT, instance=TEXT, req=FLAG, busy=FLAG, error=FLAG, status=hexadecimal(),
)  # fmt: skip
_CONTACT = record(
    group=TEXT, drive=said("The drive or station.", TEXT), direction=one_of("write", "read"), index=NUMBER,
    status=hexadecimal(8), text=TEXT, telegram=maybe({"$ref": "#/$defs/telegram"}),
)  # fmt: skip
_RESULT = record(
    parameter=TEXT, member=TEXT, title=TEXT, unit=TEXT, value=_VALUE, meaning=TEXT,
    error=maybe(hexadecimal(2)), info={"type": "integer"},
)  # fmt: skip
TRACE = {
    "spec": TEXT, "folder": TEXT, "project": TEXT, "target": TEXT, "main": TEXT, "scan_time": NUMBER, "scans": NUMBER,
    "time": said("Milliseconds.", NUMBER), "ended": one_of("jobs", "scans", "stop", ""), "summary": _table(NUMBER),
    "signals": many(_SIGNAL),
    "steps": many(
        record(scan=NUMBER, time=NUMBER, changes=_table(_VALUE), calls=many(_CALL), exchanges=many(_CONTACT))
    ),
    "jobs": many(
        record(
            job=TEXT, drive=TEXT, ending=one_of("done", "error", "running", "not_started"), status=hexadecimal(4),
            text=TEXT, scan=NUMBER, time=NUMBER, telegrams=NUMBER, retries=NUMBER, record_status=hexadecimal(8),
            record_text=TEXT, values=many(_RESULT),
        )
    ),
    "diagnostics": DIAGNOSTICS,
}  # fmt: skip

_BYTES = many(maybe({"type": "integer", "minimum": 0, "maximum": 255}))
_MESSAGE = record(
    title=TEXT, block=TEXT, size=NUMBER,
    fields=many(
        record(
            offset=NUMBER, bytes=said("null where the partner decides.", _BYTES), name=TEXT,
            role=one_of(*(role.value for role in Role)), address=TEXT, value=TEXT, meaning=TEXT,
        )
    ),
)  # fmt: skip
_WRITE = record(
    job=TEXT, block=TEXT, partners=many(TEXT), parameter=TEXT, text=TEXT, value=TEXT, input=FLAG, limits=TEXT,
    unit=TEXT, trigger=TEXT, memory=TEXT, danger=TEXT, signed=TEXT, safety=FLAG, doubts=many(TEXT),
)  # fmt: skip


def _headed(kind: str, keys: dict[str, Shape], optional: dict[str, Shape] | None = None) -> Shape:
    """A whole result: what every result begins with, and its own keys."""
    head = {"tool": {"const": "plcgen"}, "version": TEXT, "format": {"const": FORMAT}, "kind": {"const": kind}}
    return record(optional, **head, ok=said("Whether nothing is wrong.", FLAG), **keys)


def _review() -> Shape:
    comparison = {**_headed("comparison", COMPARISON)["properties"], "title": TEXT}
    keys = {
        "spec": TEXT, "folder": TEXT, "project": TEXT, "target": TEXT, "spec_sha256": SHA256, "files_sha256": SHA256,
        "included": said("What the spec includes; its hash covers these files.", many(TEXT)),
        "files": many(record(path=TEXT, sha256=SHA256, bytes=NUMBER, experimental=TEXT)), "missing": many(TEXT),
        "base": TEXT, "changes": many(record(**comparison)), "lock": maybe({"$ref": "#/$defs/comparison"}),
        "writes": many(_WRITE),
        "instances": many(record(job=TEXT, key=TEXT, partner=TEXT, address=TEXT, trigger=TEXT)),
        "telegrams": many(
            record(job=TEXT, block=TEXT, number=NUMBER, request=_MESSAGE, answers=many(_MESSAGE), lengths=_table(TEXT))
        ),
        "layouts": many(record(before=maybe(TEXT), after=maybe(TEXT), changed=FLAG)),
        "runs": many(record(job=TEXT, fault=TEXT, trace={"$ref": "#/$defs/trace"})),
        "verification": {"$ref": "#/$defs/verification"},
    }  # fmt: skip
    return _headed("review", keys)


READING = record(
    name=TEXT, address=TEXT, type_=TEXT, ok=FLAG, value=ANYTHING, hex_=hexadecimal(), return_code=hexadecimal(2),
    error=TEXT,
)  # fmt: skip


def _catalogue() -> Shape:
    fact = record(value=ANYTHING, grade=TEXT)
    parameter = record(
        device=TEXT, parameter=TEXT, name=TEXT, facts=_table(fact), observed=ANYTHING, dangerous=ANYTHING,
        changeable=ANYTHING, note=TEXT, source=TEXT,
    )  # fmt: skip
    return _headed("catalogue", {"parameters": many(parameter)}, {**FOUND, "facts": _table(NUMBER)})


def _live() -> dict[str, Shape]:
    read = record(parameter=TEXT, value=maybe(TEXT), unit=TEXT, bytes=TEXT, type=TEXT, title=TEXT)
    row = record(subject=TEXT, place=TEXT, wanted=TEXT, found=TEXT, verdict=TEXT, why=TEXT, title=TEXT, unit=TEXT)
    message = record(code=TEXT, title=TEXT, value=TEXT, case=NUMBER)
    written = record(parameter=TEXT, title=TEXT, unit=TEXT, before=TEXT, wanted=TEXT, now=TEXT)
    at = {"address": TEXT, "drive_object": NUMBER}
    saved = {**at, "file": TEXT, "parameters": NUMBER, "refused": many(TEXT)}
    compared = {"rows": many(row), "skipped": many(TEXT)}
    return {
        "live compare": _headed("live compare", FOUND, compared),
        "live db": _headed("live db", FOUND, compared),
        "live read": _headed("live read", FOUND, {**at, "parameters": many(read)}),
        "live faults": _headed("live faults", FOUND, {**at, "messages": many(message), "skipped": many(TEXT)}),
        "live backup": _headed("live backup", FOUND, saved),
        "live write": _headed("live write", FOUND, {**at, "parameters": many(written)}),
    }


def _results() -> dict[str, Shape]:
    """Every kind of result."""
    station = {"station": NUMBER}
    difference = record(address=TEXT, backup=hexadecimal(), now=hexadecimal())
    backup = {**station, "cpu": TEXT, "time": TEXT, "memory": many(TEXT), "differences": many(difference)}
    way = one_of("member", "part", "bytes", "tag", "none")
    symbol = record(symbol=TEXT, address=TEXT, type=TEXT, way=way, read=TEXT, write=TEXT, note=TEXT)
    row = {"telegram": NUMBER, "length": NUMBER, "hex": hexadecimal()}
    device = record(
        key=TEXT, title=TEXT, source=TEXT, drive_object=NUMBER, parameters=many(TEXT),
        record_index={"type": "object", "additionalProperties": {"type": ["integer", "string"]}},
    )  # fmt: skip
    change = record(parameter=TEXT, fact=TEXT, catalogue=ANYTHING, known=ANYTHING, list=ANYTHING)
    numbers = {"known": many(TEXT), "unknown": many(TEXT), "missing": many(TEXT), "ended": FLAG}
    verification = _headed("verification", VERIFICATION)
    return {
        "audit": _headed("audit", VERIFICATION),
        "catalogue": _catalogue(),
        "catalogue draw": _headed("catalogue draw", {"parameters": many(record(parameter=TEXT, title=TEXT))}),
        "catalogue import": _headed("catalogue import", {"changes": many(change), "skipped": many(TEXT)}),
        "catalogue numbers": _headed("catalogue numbers", {**numbers, "continues": maybe(NUMBER)}),
        "check": _headed(
            "check", {**FOUND, "specs": many(TEXT)}, {"baseline": record(known=NUMBER, gone=NUMBER)}
        ),
        "codes": _headed("codes", {"codes": many(record(code=TEXT, severity=TEXT, title=TEXT))}),
        "comparison": _headed("comparison", COMPARISON),
        "convert": _headed("convert", {**FOUND, "folder": TEXT, "written": many(TEXT), "unchanged": many(TEXT)}),
        "devices": _headed("devices", {"devices": many(device)}),
        "explanation": _headed(
            "explanation", {"key": TEXT, "title": TEXT, "sections": many(record(heading=TEXT, text=TEXT))}
        ),
        "generate": _headed(
            "generate", {**FOUND, "specs": many(TEXT)}, {**_WRITTEN, "projects": many(record(**_WRITTEN))}
        ),
        "layout": _headed("layout", LAYOUT),
        **_live(),
        "ppi compare": _headed("ppi compare", FOUND, backup),
        "ppi restore": _headed("ppi restore", FOUND, backup),
        "ppi info": _headed("ppi info", FOUND, {**station, "type": TEXT, "firmware": TEXT, "text": TEXT}),
        "ppi migrate": _headed(
            "ppi migrate", FOUND, {"folder": TEXT, "written": many(TEXT), "symbols": many(symbol)}
        ),
        "ppi mode": _headed("ppi mode", FOUND, {**station, "mode": one_of("RUN", "STOP")}),
        "ppi monitor": _headed("ppi monitor", FOUND),
        "ppi requests": _headed("ppi requests", {**FOUND, "telegrams": many(record(request=TEXT, **row))}),
        "ppi telegrams": _headed("ppi telegrams", {**FOUND, "telegrams": many(FRAME)}),
        "ppi values": _headed("ppi values", FOUND, {"values": many(READING)}),
        "ppi write": _headed("ppi write", FOUND, {"values": many(READING)}),
        "requests": _headed("requests", {**FOUND, "telegrams": many(record(job=TEXT, block=TEXT, **row))}),
        "review": _review(),
        "status": _headed(
            "status",
            {
                "status": hexadecimal(8), "function_num": NUMBER, "error_decode": NUMBER, "error_code_1": NUMBER,
                "error_code_2": NUMBER, "meaning": TEXT, "error": FLAG, "retry": TEXT, "advice": TEXT,
            },
        ),
        "telegrams": _headed(
            "telegrams", {"telegrams": many({"$ref": "#/$defs/telegram"}), "diagnostics": DIAGNOSTICS}
        ),
        "trace": _headed("trace", TRACE),
        "verification": verification,
        "verifications": _headed("verifications", {"verifications": many({"$ref": "#/$defs/verification"})}),
    }  # fmt: skip


def output_schema() -> Shape:
    """JSON schema (draft 2020-12) of every result; ``kind`` says which one it is."""
    results = _results()
    parts = {"note": NOTE, "diagnostic": DIAGNOSTIC, "field": FIELD, "telegram": TELEGRAM}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"urn:plcgen:output:{FORMAT}",
        "title": "plcgen results",
        "description": "What --format json writes: the key kind says which result it is.",
        "type": "object",
        "required": ["kind"],
        "properties": {"kind": {"enum": list(results)}},
        "allOf": [
            {
                "if": {"properties": {"kind": {"const": kind}}, "required": ["kind"]},
                "then": {"$ref": f"#/$defs/{_name(kind)}"},
            }
            for kind in results
        ],
        "$defs": {**parts, **{_name(kind): shape for kind, shape in results.items()}},
    }


def _name(kind: str) -> str:
    return kind.replace(" ", "-")

"""Dimensions of specs with PPI masters, and the spec that a row of them is."""

from __future__ import annotations

from typing import Any

from tests.pairs.cover import Row
from tests.pairs.drives import COMMENTS, KEYS, LANGUAGES, TRIGGERS
from tests.pairs.refusals import Refusal

DIMENSIONS: dict[str, tuple[str, ...]] = {
    "toolchain": (
        "step7-v5", "tia-v13sp1", "tia-v14", "tia-v14sp1", "tia-v15", "tia-v15.1", "tia-v16", "tia-v17", "tia-v18",
        "tia-v19", "tia-v20", "tia-v21",
    ),
    "module": ("cm1241", "cb1241", "ptp-1200", "ptp-1500", "cp341"),
    "kind": ("read", "write", "input", "run", "stop"),
    "items": ("one", "mixed", "bits", "typed", "apart", "long"),
    "stations": ("one", "two", "symbols", "table"),
    "cycle": ("none", "1s"),
    "trigger": ("member", "bit", "flags", "symbol", "tags", "inputs"),
    "languages": tuple(LANGUAGES),
    "comment": ("none", *COMMENTS),
    "key": tuple(KEYS),
    "baud": ("9600", "19200"),
    "beside": ("none", "read", "split", "alike"),
    "sources": ("one", "per_block"),
    "prefix": ("none", "short", "long"),
    "buffers": ("automatic", "numbers"),
    "owned": ("none", "Main"),
}  # fmt: skip
FAMILY = {"cm1241": "s7-1200", "cb1241": "s7-1200", "ptp-1200": "s7-1200", "ptp-1500": "s7-1500", "cp341": "s7-300"}
BASE: Row = {
    "toolchain": "tia-v19", "module": "cm1241", "kind": "read", "items": "one", "stations": "one", "cycle": "none",
    "trigger": "member", "languages": "en", "comment": "none", "key": "usual", "baud": "9600", "beside": "none",
    "sources": "one",
    "prefix": "none",
    "buffers": "automatic", "owned": "none",
}  # fmt: skip
ITEMS: dict[str, dict[str, Any]] = {
    "one": {"VW100": 7}, "mixed": {"VW100": 7, "VB200": 1, "VD300": 100000, "MB4": 3}, "bits": {"M0.0": 1, "V10.7": 0},
    "typed": {"VD100": {"type": "Real"}, "VW104": {"type": "Int", "as": "level"}},
    "apart": {f"VB{10 * n}": n for n in range(25)}, "long": {f"VD{4 * n}": n for n in range(70)},
}  # fmt: skip
REFUSALS: tuple[Refusal, ...] = (
    ((("toolchain", ("step7-v5",)), ("module", ("cm1241", "cb1241", "ptp-1200", "ptp-1500"))), "PG214"),
    ((("trigger", ("inputs",)),), "PG404"),
    ((("key", ("short",)), ("beside", ("alike",))), "PG405"),
)


def _job(row: Row) -> dict[str, Any]:
    items = ITEMS[row["items"]] | ({"UpperLevel": 7} if row["stations"] in {"symbols", "table"} else {})
    if row["kind"] in {"run", "stop"}:
        return {row["kind"]: True}
    if row["kind"] == "read":
        return {"read": [{"item": key, **(value if isinstance(value, dict) else {})} for key, value in items.items()]}
    constant = row["kind"] == "write"
    shapes = {key: value if isinstance(value, dict) else {"value": value} for key, value in items.items()}
    return {"write": {key: {**one, "value": 1} if constant else {**one, "value": None} for key, one in shapes.items()}}


def spec(row: Row) -> dict[str, Any]:
    """The spec of a row."""
    module = row["module"].replace("ptp-1200", "cm-ptp").replace("ptp-1500", "cm-ptp")
    stations: dict[str, Any] = {"pump": {"address": 2}}
    if row["stations"] == "two":
        stations["tank"] = {"address": 9, "cpu": "224"}
    elif row["stations"] == "symbols":
        stations["pump"] |= {"symbols": {"UpperLevel": "VW3000"}, "comment": "with symbols"}
    elif row["stations"] == "table":
        stations["pump"]["symbols"] = "pump.csv"
    key = KEYS[row["key"]]
    job = {"station": "pump", **_job(row)}
    job |= {"cycle": "1s"} if row["cycle"] != "none" else {}
    job |= {"trigger": TRIGGERS[row["trigger"]]} if row["trigger"] != "member" else {}
    job |= {"comment": COMMENTS[row["comment"]]} if row["comment"] != "none" else {}
    if row["buffers"] == "numbers":
        job |= {"request": {"name": "Asked", "db": 90}} | ({"response": {"db": 91}} if "run" not in job else {})
    jobs = {key: job}
    other = "tank" if "tank" in stations else "pump"
    if row["beside"] != "none":
        long = {"item": "VB1000[300]"} if row["beside"] == "split" else {"item": "VW20"}
        jobs[f"{key}2" if row["beside"] == "alike" else "beside"] = {"station": other, "read": [long]}
    port = {"address": 256} if module == "cp341" else {"port": 270}
    line = {"module": module, **port, "baud": int(row["baud"]), "stations": stations, "jobs": jobs}
    plc = {"name": "Pairs", "family": FAMILY[row["module"]], "toolchain": row["toolchain"]}
    plc |= {"sources": "per_block"} if row["sources"] != "one" else {}
    plc |= {"none": {}, "short": {"prefix": "P"}, "long": {"prefix": "Press04_"}}[row["prefix"]]
    plc |= {"user_owned": [row["owned"]]} if row["owned"] != "none" else {}
    return {"plc": {**plc, "languages": LANGUAGES[row["languages"]]}, "ppi": {"line": line}}

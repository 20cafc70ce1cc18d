"""Dimensions of specs with drive jobs, and the spec that a row of them is."""

from __future__ import annotations

from typing import Any

from tests.pairs.cover import Row

DIMENSIONS: dict[str, tuple[str, ...]] = {
    "toolchain": (
        "step7-v5", "tia-v13sp1", "tia-v14", "tia-v14sp1", "tia-v15", "tia-v15.1", "tia-v16", "tia-v17", "tia-v18",
        "tia-v19", "tia-v20", "tia-v21",
    ),
    "family": ("s7-300", "s7-400", "s7-1200", "s7-1500"),
    "device": (
        "micromaster-4", "profidrive", "sinamics-dcm", "sinamics-dcp", "sinamics-g110m", "sinamics-g115d",
        "sinamics-g120", "sinamics-g120c", "sinamics-g120x", "sinamics-g130", "sinamics-g150", "sinamics-s120",
        "sinamics-s150", "sinamics-s210", "sinamics-v90", "./acme.yaml", "./alike.yaml",
    ),
    "kind": (
        "read", "shown", "untyped", "main_values", "write", "input", "bits", "readback", "saved", "restore", "save",
        "faults", "alarms", "service", "served", "acknowledge", "compare", "steps", "until", "activate", "clock",
        "write_recipe", "read_recipe", "compare_recipe",
    ),
    "type": (
        "Boolean", "Integer8", "Integer16", "Integer32", "Integer64", "Unsigned8", "Unsigned16", "Unsigned32",
        "Unsigned64", "FloatingPoint", "Float64", "VisibleString[1]", "VisibleString[5]", "OctetString[1]",
        "OctetString[4]", "BinaryDate", "TimeOfDay", "TimeDifference", "N2", "V2", "C4", "T4",
    ),
    "languages": ("en", "de", "de-en", "zh-de-en", "en-fr", "unknown"),
    "names": ("style", "faq", "job"),
    "trigger": ("member", "bit", "flags", "symbol", "tags", "inputs"),
    "buffers": ("instance", "db", "numbers", "sizes", "members"),
    "drives": ("one", "two", "unit", "list"),
    "index": ("none", "first", "range", "many", "last", "high"),
    "times": ("default", "short", "no retries", "many retries", "long"),
    "comment": ("none", "text", "languages", "marks"),
    "key": ("short", "usual", "long", "digits"),
    "sources": ("one", "per_block"),
    "prefix": ("none", "short", "long"),
    "retain": ("yes", "no"),
    "cycle": ("no", "100ms", "1s", "1h"),
    "owned": ("none", "Main", "notes.md"),
    "scale": ("no", "0.5"),
}  # fmt: skip
BASE: Row = {
    "toolchain": "tia-v19", "family": "s7-1500", "device": "sinamics-s120", "kind": "read", "type": "FloatingPoint",
    "languages": "en", "names": "style", "trigger": "member", "buffers": "instance", "drives": "one", "index": "none",
    "times": "default", "comment": "none", "key": "usual", "sources": "one", "prefix": "none", "retain": "yes",
    "owned": "none", "cycle": "no", "scale": "no",
}  # fmt: skip
TRIPLES = (("family", "kind", "languages"),)
LANGUAGES = {
    "en": ["en-US"], "de": ["de-DE"], "de-en": ["de-DE", "en-US"], "zh-de-en": ["zh-CN", "de-DE", "en-US"],
    "en-fr": ["en-GB", "fr-FR"], "unknown": ["xx-YY", "pt-BR"],
}  # fmt: skip
KEYS = {"short": "a", "usual": "set_up", "long": "ramp_up_and_down_of_the_feeder", "digits": "job_2_0"}
TIMES: dict[str, dict[str, Any]] = {
    "default": {}, "short": {"timeout": "1500ms", "retry_pause": "20ms"}, "no retries": {"retries": 0},
    "many retries": {"retries": 10_000, "timeout": "30s"}, "long": {"timeout": "60min", "retry_pause": "2s"},
}  # fmt: skip
INDEXES = {"none": "", "first": "[0]", "range": "[1..3]", "many": "[0..69]", "last": "[32766]", "high": "[65534]"}
TRIGGERS: dict[str, Any] = {
    "bit": "M50.0",
    "flags": {"execute": "M50.0", "busy": "M50.1", "done": "M50.2", "error": "M50.3", "status": "MW52"},
    "inputs": {"execute": "I0.0", "done": "Q0.0"},
    "symbol": {"execute": "Plant.start", "done": "Plant.line[2].done"},
    "tags": {"execute": "Start_it", "busy": "Tag_2", "status": '"Tag 9"'},
}
MEMBERS = {
    "faq": ("Request_Ref", "Axis_Mirror"),
    "job": ("Request_Ref", "Axis_Mirror"),
    "style": ("requestReference", "driveObjectMirror"),
}


def _value(type_: str) -> Any:
    name, _, length = type_.rstrip("]").partition("[")
    if name == "VisibleString":
        return "abcde"[: int(length)]
    if name == "OctetString":
        return "A5" * int(length)
    if name in {"BinaryDate", "TimeOfDay", "TimeDifference"}:
        return 0
    return {"Boolean": True, "FloatingPoint": 1.5, "Float64": -2.25}.get(name, 1)


def _kind(kind: str, parameter: str, value: Any) -> dict[str, Any]:
    """What a job says of its kind."""
    several = {parameter: value, "P42990": 5.0}
    return {
        "read": {"read": [parameter, {"parameter": "P42990", "as": "x"}]},
        "shown": {"read": [parameter, "P42980.0", {"parameter": "P42980.15", "as": "x"}]},
        "untyped": {"read": ["r42970", parameter, {"parameter": "r42971[2]", "as": "x"}]},
        "main_values": {"read": ["main_values", {"parameter": "P42990", "as": "x"}]},
        "write": {"write": several},
        "input": {"write": {parameter: None, "P42990": {"as": "ramp", "start": 2.0}}},
        "bits": {"write": {"P42980.0": 1, "P42980.15": None, "P42980.7": {"as": "enable"}}},
        "readback": {"write": several, "verify": "readback"},
        "saved": {"write": several, "verify": "readback", "save": "drive_object"},
        "restore": {"write": several, "verify": "readback", "on_error": {"restore": "running", "reason": "tried"}},
        "save": {"save": "drive_object"},
        "faults": {"faults": "current"},
        "alarms": {"alarms": "current"},
        "service": {"service": "read"},
        "served": {"service": {"write": True}, "allow": {"P42990": "tried"}},
        "acknowledge": {"acknowledge": True},
        "compare": {"compare": several},
        "steps": {"sequence": [{"write": several}, {"read": [parameter]}, {"write": {"P42990": None}}]},
        "until": {
            "sequence": [
                {"until": {parameter: value, "P42980.1": 1, "P42980.2": 0, "timeout": "3s"}},
                {"until": {"P42990": "> 100.0"}, "read": ["P42980"]},
                {"until": {"P42990": "< 1.0", "interval": "200ms"}},
            ]
        },
        "activate": {"activate": "input"},
        "clock": {"clock": "utc"},
        "write_recipe": {"write_recipe": "set"},
        "read_recipe": {"read_recipe": "set"},
        "compare_recipe": {"compare_recipe": "set"},
    }[kind]


COMMENTS: dict[str, Any] = {
    "text": "what it is for",
    "languages": {"en-US": "for readers", "de-DE": "für Leser"},
    "marks": "a (* b *) // 'c' \"d\" $e {f} <g>&h",
}


def spec(row: Row) -> dict[str, Any]:
    """The spec of a row."""
    classic = row["family"] in {"s7-300", "s7-400"}
    place = "address" if classic else "hardware_id"
    values: dict[str, Any] = {"P43000": {"type": row["type"]}}
    values["P43000"] |= {"scale": 0.5} if row["scale"] != "no" else {}
    values |= {"P42990": {"type": "FloatingPoint", "name": "level"}, "P42980": {"type": "Unsigned16"}}
    device, number = row["device"], {"two": 2, "unit": 2, "list": 2}.get(row["drives"], 1)
    each: list[dict[str, Any]] = [{place: 256 + 20 * n, "parameters": values} for n in range(number)]
    first = 1 if row["kind"] == "clock" else 3
    for one in each if row["kind"] == "clock" else ():
        one["drive_object"] = 1
    keys = ["axis", "other"][:number]
    sections: dict[str, Any] = {}
    if row["drives"] == "unit":
        owned = {key: {**one, "drive_object": first + n} for n, (key, one) in enumerate(zip(keys, each, strict=True))}
        sections["units"] = {"cu": {"device": device, "drives": owned}}
    else:
        sections["drives"] = {key: {"device": device, **one} for key, one in zip(keys, each, strict=True)}
    parameter = f"P43000{INDEXES[row['index']]}"
    job: dict[str, Any] = {"drive": keys if row["drives"] == "list" else "axis"}
    job |= _kind(row["kind"], parameter, _value(row["type"])) | TIMES[row["times"]]
    job |= {"cycle": row["cycle"]} if row["cycle"] != "no" else {}
    if row["trigger"] != "member":
        job["trigger"] = TRIGGERS[row["trigger"]]
    asked, answered = MEMBERS[row["names"]]
    job |= {
        "instance": {}, "db": {"buffers": "db"}, "numbers": {"request": {"db": 90}, "response": {"db": 91}},
        "sizes": {"response": {"size": 200, "name": "Answer"}},
        "members": {
            "request": {"name": "Asked", "members": {asked: "Reference"}},
            "response": {"size": 190, "members": {answered: "Axis_of"}},
        },
    }[row["buffers"]]  # fmt: skip
    if row["comment"] != "none":
        job["comment"] = COMMENTS[row["comment"]]
    if row["names"] == "job":
        job["names"] = "faq"
    if "recipe" in row["kind"]:
        names = row["key"] in {"usual", "long"}
        parameters = [parameter, {"parameter": "P42990", "as": "speed", "start": 10.0}]
        sections["recipes"] = {
            "set": {"parameters": parameters, "records": {"a": {}, "b2": {"speed": 1.0}} if names else 3}
        }
        sections["recipes"]["set"] |= {"retain": False} if row["retain"] == "no" else {}
    jobs = {KEYS[row["key"]]: job}
    if row["drives"] == "two":
        jobs["beside"] = {"drive": "other", "read": ["P42990"]}
    plc = {
        "name": "Pairs",
        "family": row["family"],
        "toolchain": row["toolchain"],
        "languages": LANGUAGES[row["languages"]],
    }
    plc |= {"sources": "per_block"} if row["sources"] != "one" else {}
    plc |= {"none": {}, "short": {"prefix": "P"}, "long": {"prefix": "Press04_"}}[row["prefix"]]
    plc |= {"names": "faq"} if row["names"] == "faq" else {}
    plc |= {"user_owned": [row["owned"]]} if row["owned"] != "none" else {}
    return {"plc": plc, **sections, "jobs": jobs}

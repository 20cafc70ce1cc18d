"""Texts of a spec that would be code, markup or a formula: whatever is generated says the same without them.

Every text of a spec at once is one of these. Sources have the same tokens as with a harmless word, documents the same
elements, tables the same cells. ``make hostile`` does so with every text for every shipped spec, ``make test`` with a
quarter of them for each target.
"""

from __future__ import annotations

import csv
import io
import json
import os
import re
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest

from plcgen import api
from plcgen.base.diagnostics import Severity
from plcgen.base.files.workbook import read_sheets
from plcgen.s7.scl.lexer import tokenize
from tests import wrong_shapes
from tests.projects import ROOT
from tests.yaml_files import read_yaml

pytestmark = pytest.mark.slow
HARMLESS = "harmless"
PAYLOADS = (
    "x: INT; END_VAR BEGIN", "*) y := 1; (*", "// y", 'a" := 1; "', "a'; y := '", "$'$N y", "END_COMMENT */ y",
    "<img src=x onerror=alert(1)>", "</Comment>&amp;<!--", "]]>", "=cmd|' /C calc'!A0", "+1+1", "-1", "@SUM(A1)",
    "|a|b|", "`x` **b** [l](javascript:y)", "{{ 7 * 7 }}{% x %}", "\\u000a y", "%0A y", "; y", "\t| y",
)  # fmt: skip
STEMS = [
    "s7-300_plant_v5", "s7-300_6ra80_dp_tia", "s7-1200_s120_recipe", "s7-1500_g120_readback", "s7-1500_s120_messages",
    "s7-1200_s7-200_ppi", "s7-300_s7-200_ppi_cp341",
]  # fmt: skip
HOSTILE = "PLCGEN_HOSTILE" in os.environ
if HOSTILE:
    STEMS = sorted(path.stem for path in (ROOT / "specs").glob("*.yaml"))


def filled(stem: str, text: str) -> Any:
    """A shipped spec in which every job, drive, recipe, port and station has a comment, and every text is this one."""
    source = re.sub(r"(?<=[ {\[])16#([0-9A-F]+)", r"0x\1", (ROOT / f"specs/{stem}.yaml").read_text("utf-8"))
    data = json.loads(json.dumps(read_yaml(source)))
    data["plc"]["name"] = text
    for section in ("jobs", "drives", "recipes", "ppi"):
        for entry in (data.get(section) or {}).values():
            entry["comment"] = text
            for inner in ("stations", "jobs"):
                for one in (entry.get(inner) or {}).values():
                    one["comment"] = text
    for job in (data.get("jobs") or {}).values():
        if "allow" in job:
            job["allow"] = dict.fromkeys(job["allow"], text)
    for path in list(wrong_shapes.places(data)):
        if path[-1:] in {("title",), ("why",), ("reason",), ("text",), ("allow",)}:
            above = wrong_shapes.at(data, path[:-1])
            if isinstance(above[path[-1]], str):
                above[path[-1]] = text
    return data


def accepted(stem: str, text: str, path: Path) -> int:
    """Write the spec with this text wherever it is accepted, HARMLESS elsewhere; in how many places it is."""
    lines = json.dumps(filled(stem, text), indent=1, ensure_ascii=False).split("\n")
    spelled, harmless = json.dumps(text, ensure_ascii=False), json.dumps(HARMLESS)
    for _ in range(3):
        path.write_text("\n".join(lines), "utf-8")
        wrong = [one for one in api.check(path).diagnostics if one.severity is Severity.ERROR]
        if not wrong:
            break
        for line in {one.span.line - 1 for one in wrong}:
            assert spelled in lines[line], wrong
            lines[line] = lines[line].replace(spelled, harmless)
    return sum(spelled in line for line in lines)


_FREE = re.compile(r"^(\s*(?:TITLE =|REGION|NAME :)).*", re.MULTILINE)
"""What the compiler reads to the end of the line, and the hash of all of it."""


def shape(name: str, data: bytes) -> list[object]:
    """What a file is made of besides its texts."""
    ending = name.rpartition(".")[2]
    if ending == "xlsx":
        return [len(cells) for sheet in read_sheets(data, 10_000) for _, cells in sheet]
    text = data.decode("utf-8-sig" if _is_utf8(data) else "cp1252")
    if ending in {"scl", "udt", "db"}:
        found = tokenize(_FREE.sub(r"\1", text), name)
        return [
            *zip(found.kinds, found.texts, strict=True),
            len(re.findall(r"//|\(\*|\*\)", re.sub(r"//.*", "//", text))),
        ]
    if ending == "xml":
        return [element.tag for element in ET.fromstring(text).iter()]  # our own output
    if ending in {"csv", "sdf", "asc"}:
        rows = csv.reader(io.StringIO(text), delimiter=";" if ";" in text.split("\n")[0] else ",")
        return [(len(row), [cell[:1] for cell in row if cell[:1] in tuple("=+-@\t\r")]) for row in rows]
    if ending == "md":
        bare = re.sub(r"\\.|(`+).*?\1|&lt;", "", text)
        return [(line.count("|"), line.count("<"), line.count("]("), line[:1] == "#") for line in bare.split("\n")]
    return []


def _is_utf8(data: bytes) -> bool:
    try:
        data.decode()
    except UnicodeDecodeError:
        return False
    return True


def generated(path: Path, out: Path) -> dict[str, list[object]]:
    """The shape of every file that is generated from a spec; the one source is called after the project."""
    made = api.generate(path, out, force=True)
    assert made.ok, made.diagnostics
    files = sorted(each for each in out.rglob("*") if each.is_file())
    names = ["source.scl" if each.parent == out and each.suffix == ".scl" else each.relative_to(out).as_posix()
             for each in files]  # fmt: skip
    return {name: shape(name, each.read_bytes()) for name, each in zip(names, files, strict=True)}


@pytest.mark.parametrize("stem", STEMS)
def test_a_text_stays_a_text(stem: str, tmp_path: Path) -> None:
    """Each file has the shape that it has with a harmless word, and what cannot be shown so is refused."""
    path = tmp_path / "spec.yaml"
    assert accepted(stem, HARMLESS, path)
    plain = generated(path, tmp_path / "out")
    wrong, places = {}, 0
    for payload in PAYLOADS if HOSTILE else PAYLOADS[STEMS.index(stem) % 4 :: 4]:
        count = accepted(stem, payload, path)
        places += count
        if count:
            found = generated(path, tmp_path / "out")
            assert found.keys() == plain.keys()
            unlike = [name for name in found if found[name] != plain[name]]
            if unlike:
                wrong[payload] = unlike
    assert wrong == {}
    assert places

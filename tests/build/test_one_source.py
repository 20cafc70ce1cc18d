"""All blocks in one source: their order by the rules of STEP 7, the text of each, what does not fit into it."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from plcgen import api
from plcgen.build import one_source
from tests.projects import SPECS, TARGETS, every_type

_HEAD = re.compile(r'^(TYPE|DATA_BLOCK|FUNCTION_BLOCK|ORGANIZATION_BLOCK) "?([^"\s]+)"?', re.MULTILINE)
_QUOTED = re.compile(r'"([^"\n]+)"')
TEXTS = {spec.stem: spec.read_text("utf-8") for spec in SPECS} | {key: every_type(key) for key in TARGETS}
PUMP = (
    "plc: {name: Pump station, family: s7-1500, toolchain: tia-v19}\n"
    "drives: {pump: {device: sinamics-g120, hardware_id: 270}}\n"
    "jobs: {read_speed: {drive: pump, read: [r21]}, set_ramp: {drive: pump, write: {P1120: 5.0}}}\n"
)


def generated(text: str, folder: Path, *, per_block: bool = False) -> Path:
    """Files of a spec, in either form."""
    folder.mkdir(parents=True, exist_ok=True)
    text = text.replace("sources: per_block, ", "")
    spec = folder / "job.yaml"
    spec.write_text(re.sub(r"plc: *\{", "plc: {sources: per_block, ", text, count=1) if per_block else text, "utf-8")
    result = api.generate(spec, folder / "out")
    assert result.ok, [f"{one.span} {one.code} {one.message}" for one in result.diagnostics]
    return folder / "out"


def pieces(text: str) -> list[tuple[str, str, str]]:
    """Kind, name and text of every block of a source, in order."""
    heads = list(_HEAD.finditer(text))
    ends = [*(head.start() for head in heads[1:]), len(text)]
    return [(head[1], head[2], text[head.start() : end]) for head, end in zip(heads, ends, strict=True)]


@pytest.mark.slow
@pytest.mark.parametrize("name", TEXTS)
def test_every_block_stands_behind_what_it_needs(name: str, tmp_path: Path) -> None:
    """Programming with STEP 7, 13.2.3: types, shared data, called before calling blocks, instances behind theirs."""
    out = generated(TEXTS[name], tmp_path)
    (source,) = out.glob("*.scl")
    data = source.read_bytes()
    classic = "step7-v5" in TEXTS[name]
    assert data.startswith(b"\xef\xbb\xbf") != classic
    assert (b"\r\n" in data) == classic
    assert data.count(b"\xef\xbb\xbf") == (not classic)
    found = pieces(data.decode("cp1252" if classic else "utf-8-sig").replace("\r\n", "\n"))
    kinds = [kind for kind, _, _ in found]
    assert kinds == sorted(kinds[: kinds.index("DATA_BLOCK")], reverse=True) + kinds[kinds.index("DATA_BLOCK") :]
    assert "ORGANIZATION_BLOCK" not in kinds
    names = {block for _, block, _ in found}
    seen: set[str] = set()
    for _, block, text in found:
        seen.add(block)
        assert (set(_QUOTED.findall(text)) & names) - seen == set(), block


@pytest.mark.slow
@pytest.mark.parametrize("name", TEXTS)
def test_the_blocks_are_those_of_a_file_for_each(name: str, tmp_path: Path) -> None:
    """Both forms have the same text for every block; the example and the documents do not differ at all."""
    one, many = generated(TEXTS[name], tmp_path / "1"), generated(TEXTS[name], tmp_path / "2", per_block=True)
    (source,) = one.glob("*.scl")
    files = [path for room in ("udt", "db", "scl") for path in (many / room).glob("*") if path.stem != "Main"]
    texts = [path.read_bytes().removeprefix(b"\xef\xbb\xbf") for path in files]
    joined = source.read_bytes().removeprefix(b"\xef\xbb\xbf")
    between = b"\r\n" if b"\r\n" in joined else b"\n"
    assert all(text in joined for text in texts)
    assert len(joined) == sum(map(len, texts)) + len(between) * (len(texts) - 1)
    assert (one / "example/Main.scl").read_bytes() == (many / "scl/Main.scl").read_bytes()
    beside = {path.relative_to(one): path.read_bytes() for room in ("xml", "watch") for path in one.glob(f"{room}/*")}
    assert beside == {path.relative_to(many): path.read_bytes() for path in map(many.joinpath, beside)}


def test_the_folder_has_a_dozen_names_and_a_guide_of_one_screen(tmp_path: Path) -> None:
    """Two jobs: the source, the example, tables, documents; the guide begins with the step that is done first."""
    out = generated(PUMP, tmp_path)
    assert {path.name for path in out.iterdir()} == {
        "Pump_station.scl", "example", "xml", "watch", "IMPORT.md", "LAYOUT.md", "manifest.json", ".gitattributes",
    }  # fmt: skip
    guide = (out / "IMPORT.md").read_text("utf-8").splitlines()
    assert len(guide) <= 42
    assert guide[2].startswith("1. External source files > Add new external file: `Pump_station.scl`.")


def test_another_form_takes_away_the_files_of_the_first(tmp_path: Path) -> None:
    """Nothing is there twice, and what the user has changed or made is not removed."""
    out = generated(PUMP, tmp_path)
    (out / "notes.txt").write_text("mine")
    generated(PUMP, tmp_path, per_block=True)
    assert not list(out.glob("*.scl"))
    assert not (out / "example").exists()
    changed = out / "scl/ReadSpeed.scl"
    changed.write_bytes(changed.read_bytes() + b"// mine\n")
    spec = tmp_path / "job.yaml"
    spec.write_text(PUMP, "utf-8")
    result = api.generate(spec, out)
    assert [one.code for one in result.diagnostics] == ["PG502"]
    assert [path.name for path in out.glob("*.scl")] == ["Pump_station.scl"]
    assert changed.read_bytes().endswith(b"// mine\n")
    assert not (out / "udt").exists()
    assert (out / "notes.txt").exists()


@pytest.mark.slow
def test_verify_diff_and_lock_take_both_forms(tmp_path: Path) -> None:
    """The same checks pass, a comparison finds nothing, a lock of one form accepts the other."""
    one, many = generated(PUMP, tmp_path / "1"), generated(PUMP, tmp_path / "2", per_block=True)
    checks = [
        [(check.id, check.outcome.value) for check in api.verify(folder.parent / "job.yaml", folder).checks()]
        for folder in (one, many)
    ]
    assert checks[0] == checks[1]
    assert ("coverage.read_speed", "ok") in checks[0]
    assert api.diff(one, many).changes == ()
    lock = tmp_path / "plc.lock"
    assert api.lock(one, out=lock).ok
    assert api.check_lock(many, lock=lock).changes == ()


NAMES = {
    "Pump station": "Pump_station.scl", "../../x": "x.scl", "con": "con_.scl", "Linie 3/4: Öfen": "Linie_3_4_Öfen.scl",
    "泵站": "泵站.scl", "...": "PLC.scl", "IMPORT": "IMPORT.scl", "a" * 60: "a" * 24 + ".scl",
}  # fmt: skip


@pytest.mark.parametrize("name", NAMES)
def test_the_file_is_called_as_the_plc(name: str, tmp_path: Path) -> None:
    """As far as Windows and STEP 7 have such names: letters, digits, a few others."""
    out = generated(PUMP.replace("Pump station", json.dumps(name, ensure_ascii=False)), tmp_path)
    assert [path.name for path in out.glob("*.scl")] == [NAMES[name]]


def test_step7_v5_has_names_of_latin_letters(tmp_path: Path) -> None:
    """What is no letter of ASCII becomes an underscore there."""
    text = PUMP.replace("family: s7-1500, toolchain: tia-v19", "family: s7-300, toolchain: step7-v5")
    text = text.replace("Pump station", "Öfen 1").replace("hardware_id: 270", "address: 256")
    assert [path.name for path in generated(text, tmp_path).glob("*.scl")] == ["fen_1.scl"]
    assert not (tmp_path / "out/compile.inp").exists()


def test_a_source_that_nothing_reads_is_not_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """PG512 with the size and the way out; with a file for each block it is generated."""
    monkeypatch.setattr(one_source, "MAX_CHARACTERS", 20_000)
    spec = tmp_path / "job.yaml"
    spec.write_text(PUMP, "utf-8")
    (found,) = api.generate(spec, tmp_path / "out").diagnostics
    assert (found.code, found.help) == ("PG512", "write plc: {sources: per_block}")
    assert "20,000" in found.message
    assert not (tmp_path / "out").exists()
    generated(PUMP, tmp_path / "2", per_block=True)


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ('FUNCTION_BLOCK "ReadSpeed"\n', 'FUNCTION_BLOCK "ReadSpeed"\nKNOW_HOW_PROTECT\n', "KNOW_HOW_PROTECT"),
        ("swap", "", "DriveCalls_DB comes before DriveCalls, which it needs"),
    ],
)
def test_a_block_in_the_middle_is_looked_at_like_one_alone(before: str, after: str, said: str, tmp_path: Path) -> None:
    """Words of a header, and the order of blocks, are read block by block."""
    out = generated(PUMP, tmp_path)
    source = out / "Pump_station.scl"
    text = source.read_bytes().decode("utf-8-sig")
    if before == "swap":
        *others, calls, instance = [piece for _, _, piece in pieces(text)]
        text = "".join([*others, instance, calls])
    else:
        assert before in text
        text = text.replace(before, after)
    source.write_bytes(text.encode("utf-8-sig"))
    found = [check.diagnostic.message for check in api.verify(tmp_path / "job.yaml", out, faults="none").checks()
             if check.diagnostic is not None]  # fmt: skip
    assert any(said in message for message in found), found

"""``include:`` and ``variables:``: a spec of several files says what one file with the same lines says."""

from __future__ import annotations

import json
import pickle
from itertools import pairwise
from pathlib import Path

import pytest

from plcgen import api
from plcgen.base.diagnostics import Report
from plcgen.project.below import specs_below
from plcgen.project.includes import MAX_FILES, MAX_LEVELS
from plcgen.project.loading import load_spec
from plcgen.project.opening import open_spec

PLANT = """\
plc: {family: s7-1500, toolchain: tia-v19}
include: parameters.yaml
drives:
  fan: {device: sinamics-g120, parameters: $(limits)}   # plcgen: allow PG228 the list manual says so
"""
PARAMETERS = """\
variables:
  ramp: 5.0
  limits: {P2900: {type: FloatingPoint, name: tension, min: 0.0, max: 100.0}}
"""
SPEC = """\
include: [common/plant.yaml]
variables: {ramp: 7.5, line: 3}
plc: {name: Line $(line)}
drives: {fan: {hardware_id: 270}}
jobs: {set: {drive: fan, write: {P1120: $(ramp), tension: $(ramp)}}}
"""
WRITTEN_OUT = """\
plc: {name: Line 3, family: s7-1500, toolchain: tia-v19}
drives:
  fan:
    hardware_id: 270
    device: sinamics-g120
    parameters: {P2900: {type: FloatingPoint, name: tension, min: 0.0, max: 100.0}}
jobs: {set: {drive: fan, write: {P1120: 7.5, tension: 7.5}}}
"""


@pytest.fixture
def spec(tmp_path: Path) -> Path:
    """A spec that includes a file, which includes another one beside it."""
    (tmp_path / "common").mkdir()
    (tmp_path / "common" / "plant.yaml").write_text(PLANT, "utf-8")
    (tmp_path / "common" / "parameters.yaml").write_text(PARAMETERS, "utf-8")
    (tmp_path / "job.yaml").write_text(SPEC, "utf-8")
    return tmp_path / "job.yaml"


def told(spec: Path) -> list[tuple[str, str, int, int]]:
    """Code, file, line and column of every problem but notes."""
    found = [d for d in api.check(spec).diagnostics if d.severity.label != "note"]
    return [(d.code, Path(d.span.file).name, d.span.line, d.span.column) for d in found]


def test_it_is_one_spec(spec: Path) -> None:
    """The same plan, the same files but for the hash in the manifest, which names what was included."""
    (spec.parent / "out.yaml").write_text(WRITTEN_OUT, "utf-8")
    made, written_out = spec.parent / "made", spec.parent / "written_out"
    assert api.generate(spec, made).ok
    assert api.generate(spec.parent / "out.yaml", written_out).ok
    files = {path.relative_to(made) for path in made.rglob("*") if path.is_file()}
    assert files == {path.relative_to(written_out) for path in written_out.rglob("*") if path.is_file()}
    manifest = Path("manifest.json")
    assert [
        name for name in files - {manifest} if (made / name).read_bytes() != (written_out / name).read_bytes()
    ] == []
    assert json.loads((made / manifest).read_text())["included"] == ["common/parameters.yaml", "common/plant.yaml"]
    assert "included" not in json.loads((written_out / manifest).read_text())


def test_a_change_of_an_included_file_is_a_change(spec: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its hash is in the manifest, wherever the command is started; line ends do not count."""
    assert api.generate(spec).ok
    monkeypatch.chdir(spec.parent)
    shared = spec.parent / "common" / "parameters.yaml"
    shared.write_bytes(shared.read_bytes().replace(b"\n", b"\r\n"))
    assert api.generate("job.yaml", check_only=True).ok
    shared.write_text(PARAMETERS + "# more\n")
    assert [d.code for d in api.generate("job.yaml", check_only=True).diagnostics if d.severity.label == "error"] == [
        "PG504"
    ]


def test_a_problem_stands_in_the_included_file(spec: Path) -> None:
    """Shapes, unknown names and limits alike, together with those of the spec; a comment there allows its warnings."""
    assert told(spec) == []
    (spec.parent / "common" / "plant.yaml").write_text(
        PLANT.replace("sinamics-g120", "g120") + "colour: red\n", "utf-8"
    )
    spec.write_text(SPEC.replace("hardware_id: 270", "hardware_id: 270, axis: 1"), "utf-8")
    assert set(told(spec)) == {
        ("PG104", "plant.yaml", 5, 1),
        ("PG201", "plant.yaml", 4, 17),
        ("PG104", "job.yaml", 4, 34),
    }


def test_a_value_tells_where_it_comes_from(spec: Path) -> None:
    """The place of the use, the definition as a note, in an included file too."""
    spec.write_text(SPEC.replace("ramp: 7.5, ", ""), "utf-8")
    shared = spec.parent / "common" / "parameters.yaml"
    shared.write_text(PARAMETERS.replace("5.0", "500.0"), "utf-8")
    (found,) = (d for d in api.check(spec).diagnostics if d.code == "PG209")
    assert (found.span.line, found.span.column) == (5, 59)
    assert [(note.message, Path(note.span.file).name, note.span.line) for note in found.notes] == [
        ('the value of "ramp"', "parameters.yaml", 2)
    ]
    shared.write_text(PARAMETERS.replace("5.0", "{colour: 1}"), "utf-8")
    assert told(spec)[0][1] == "parameters.yaml"


def test_types_are_kept_unless_in_quotes(tmp_path: Path) -> None:
    """A number stays one, in quotes it is its text as written; a text that looks like a number stays text."""
    path = tmp_path / "job.yaml"
    path.write_text(
        "variables: {n: 16#0A, t: '7', no: false}\n"
        'plc: {name: "$(n)/$(t)", family: s7-300, toolchain: tia-v16}\n'
        "drives: {d: {device: sinamics-dcm, address: $(n), output_address: $(no), comment: $(t)}}\n"
        "jobs: {j: {drive: d, read: [P50303]}}\n",
        "utf-8",
    )
    project = open_spec(path).sound()
    root = project.loaded.root
    assert project.name == "16#0A/7"
    drive = root.find(("drives", "d"))
    assert [drive.find((key,)).value for key in ("address", "output_address", "comment")] == [10, False, "7"]
    path.write_text(path.read_text().replace("address: $(n)", 'address: "$(n)"'))
    (found,) = (d for d in api.check(path).diagnostics if d.severity.label == "error")
    assert (found.code, found.span.line) == ("PG106", 3)


def test_a_worker_needs_no_file(spec: Path) -> None:
    """The spec crosses to another process with the texts that were read."""
    loaded = load_spec(spec, Report())
    assert loaded is not None
    data = pickle.dumps(loaded)
    (spec.parent / "common" / "plant.yaml").unlink()
    again = pickle.loads(data)  # noqa: S301 - our own
    assert (again.digest, again.root.data()) == (loaded.digest, loaded.root.data())


def test_an_included_file_is_no_spec_of_the_folder(spec: Path) -> None:
    """``check folder/`` does not check the plant alone."""
    assert [path.name for path in specs_below(spec.parent).specs] == ["job.yaml"]


def test_what_is_included_stays_below_the_folder(tmp_path: Path) -> None:
    """Through a link neither; nothing of the file is shown."""
    (tmp_path / "machine").mkdir()
    (tmp_path / "secret.yaml").write_text("password: 1\n")
    (tmp_path / "machine" / "link.yaml").symlink_to(tmp_path / "secret.yaml")
    path = tmp_path / "machine" / "job.yaml"
    path.write_text("include: [link.yaml]\n" + WRITTEN_OUT, "utf-8")
    (found,) = api.check(path).diagnostics
    assert (found.code, found.span.line, "password" in found.message) == ("PG112", 1, False)


@pytest.mark.parametrize("kind", ["levels", "files", "bytes"])
def test_it_is_bounded(kind: str, tmp_path: Path) -> None:
    """Chains, crowds and giants end in one diagnostic."""
    names = [f"f{n}.yaml" for n in range(MAX_FILES + 2)]
    chain = kind == "levels"
    for name, after in pairwise(names):
        text = f"include: {after}\n" if chain else "variables: {}\n"
        (tmp_path / name).write_text(text + ("#" * 9_000_000 if kind == "bytes" and name < "f1z" else ""))
    wanted = names[:1] if chain else names[:2] if kind == "bytes" else names[:-1]
    (tmp_path / "job.yaml").write_text(f"include: [{', '.join(wanted)}]\n{WRITTEN_OUT}")
    (found,) = api.check(tmp_path / "job.yaml").diagnostics
    words = {"levels": f"through more than {MAX_LEVELS}", "files": f"more than {MAX_FILES} files", "bytes": "16 MiB"}
    assert found.code == "PG112"
    assert words[kind] in found.message


def test_variables_do_not_multiply(tmp_path: Path) -> None:
    """Neither mappings nor texts grow without an end."""
    many = ", ".join(["$(big)"] * 1500)
    path = tmp_path / "job.yaml"
    for value, use in ((str(list(range(1000))), f"[{many}]"), ("x" * 20_000, f'"{many}"')):
        path.write_text(f"variables: {{big: {value}}}\n{WRITTEN_OUT.replace('P1120: 7.5', f'P1120: {use}')}")
        (found,) = api.check(path).diagnostics
        assert (found.code, "expands to more" in found.message) == ("PG109", True)


def test_the_review_names_what_is_included(spec: Path) -> None:
    """Beside the hash that covers it."""
    from plcgen.base.display.view import PLAIN
    from plcgen.report.registry import output_format

    assert api.generate(spec).ok
    review = api.review(spec, faults="none")
    assert review.included == ("common/parameters.yaml", "common/plant.yaml")
    for name in ("html", "json", "markdown"):
        format_ = output_format(name)
        assert format_ is not None
        assert "parameters.yaml" in format_.render("review", review, PLAIN).replace("<wbr>", "")

"""Everything generated is made of what genuine exports are made of; ``tests/evidence/unseen.toml`` argues the rest."""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from pathlib import Path

import pytest

from plcgen.build.rendering import render_project
from plcgen.project.opening import open_spec
from plcgen.s7.xml.reading.xml import parse_xml
from plcgen.s7.xml.spelling import VERSIONS
from tests.evidence import simaticml
from tests.evidence.__main__ import main
from tests.evidence.signatures import Signature, data_type, literal, signatures
from tests.projects import EVERY_TYPE, ROOT, SPECS

DOCUMENT = """<Document><Engineering version="V18" /><SW.Blocks.FC ID="0"><AttributeList>
<Interface><Sections xmlns="http://www.siemens.com/automation/Openness/SW/Interface/v5"><Section Name="Temp">
<Member Name="secretName" Datatype="Array[0..9, 1..&quot;SECRET&quot;] of &quot;secretType&quot;" />
</Section></Sections></Interface><Name>secret block</Name></AttributeList></SW.Blocks.FC></Document>"""
FAMILIES = ("s7-400", "s7-1200", "s7-1500")


def test_a_signature_has_nothing_that_the_author_of_a_document_wrote() -> None:
    """Names, bounds and user types become classes; the words of the TIA Portal stay."""
    assert set(signatures(parse_xml(DOCUMENT.encode(), "x"))) >= {
        ("Document", "Engineering", "version", "version"),
        ("SW.Blocks.FC/Sections", "Section", "Name", "Temp"),
        ("SW.Blocks.FC/Sections", "Section", "()", "Name=Temp"),
        ("Section", "Member", "()", "Datatype Name"),
        ("Section", "Member", "Name", "name"),
        ("Section", "Member", "Datatype", 'Array[,] of "user type"'),
        ("SW.Blocks.FC/AttributeList", "Name", ".", "text"),
    }
    assert "secret" not in str(list(signatures(parse_xml(DOCUMENT.encode(), "x")))).lower()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("TRUE", "true or false"), ("-5", "integer"), ("-1.5E-3", "real"), ("16#FF", "number with base"),
        ("'it'", "string"), ("P#DB3.DBX0.0 BYTE 10", "P#"), ("P# I247.0 BYTE 20", "P# and a blank"),
        ("t#10s", "T#"), ("S5T#1m", "S5T#"), ("MAX_PUMPS", "name"), ('"a b"', "name"), ("(a := 1)", "other"),
    ],
)  # fmt: skip
def test_literals_have_classes(text: str, expected: str) -> None:
    """The class says what an importer must understand."""
    assert literal(text) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("String[16]", "String[]"),
        ('"Motor"', '"user type"'),
        ("Array[0..9] of Word", "Array[] of Word"),
        ("a.b!", "other"),
    ],
)
def test_types_have_classes(text: str, expected: str) -> None:
    """Lengths, bounds and names of users are left out."""
    assert data_type(text) == expected


def argued() -> list[Signature]:
    """What is known not to have been seen."""
    groups = tomllib.loads((ROOT / "tests" / "evidence" / "unseen.toml").read_text("utf-8"))["unseen"]
    assert all(group["what"] and group["why"] for group in groups)
    return sorted(tuple(signature) for group in groups for signature in group["signatures"])


def test_the_page_lists_what_was_not_seen() -> None:
    """Every group, and no other."""
    groups = tomllib.loads((ROOT / "tests" / "evidence" / "unseen.toml").read_text("utf-8"))["unseen"]
    page = (ROOT / "docs" / "simaticml.md").read_text("utf-8")
    listed = page[: page.index("<!-- unseen -->")].rpartition("\n\n")[2]
    assert listed.splitlines() == [f"- {group['what']}" for group in groups]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> dict[Signature, Counter[str]]:
    """Signatures of every data type of all families for V15 to V21, and of each shipped spec for three of them.

    The oldest, the newest, and one between them: another one for the next spec.
    """
    spec = tmp_path_factory.mktemp("evidence") / "spec.yaml"
    versions = [name for name in VERSIONS if simaticml.age(name) >= (15,)]
    assert (versions[0], versions[-1]) == ("V15", "V21")
    found, seen = simaticml.Summary(), set[bytes]()
    for version in versions:
        position = versions.index(version)
        ends = version in {versions[0], versions[-1]}
        chosen = (one for n, one in enumerate(SPECS) if ends or 1 + n % (len(versions) - 2) == position)
        texts = [one.read_text("utf-8") for one in chosen]
        texts += [EVERY_TYPE.format(family=family, toolchain="tia") for family in FAMILIES]
        for text in texts:
            spec.write_text(re.sub(r"toolchain: [\w.-]+", f"toolchain: tia-{version.lower()}", text), "utf-8")
            files = render_project(open_spec(spec).sound())
            for data in {file.data for file in files if file.path.endswith(".xml")} - seen:
                seen.add(data)
                found.add(parse_xml(data, "x"), "")
    assert found.versions.keys() == set(versions)
    assert sum(found.versions.values()) > 1000
    return found.found


@pytest.mark.slow
def test_generated_documents_have_no_signature_that_is_neither_seen_nor_argued(
    made: dict[Signature, Counter[str]],
) -> None:
    """What is argued was not seen: nothing stays on the list for longer than it must."""
    assert set(simaticml.unseen(made, simaticml.read())) - set(argued()) == set()
    assert set(argued()) & set(simaticml.read()) == set()


@pytest.mark.slow
def test_what_only_newer_versions_write_was_not_first_seen_in_a_newer_one(made: dict[Signature, Counter[str]]) -> None:
    """HasQuotes of global names from V18 on, Namespace of types: counted in that version or before."""
    known = simaticml.read()
    newer = [s for s, counts in made.items() if "V15" not in counts and s in known]
    assert ("Component", "BooleanAttribute", "Name", "HasQuotes") in newer
    for signature in newer:
        first = min(map(simaticml.age, made[signature]))
        assert min(map(simaticml.age, known[signature])) <= first, signature


def test_the_summary_was_made_from_enough_documents() -> None:
    """At least 800 of V15 to V21; its first lines say how many of each version."""
    count, repositories = re.findall(
        r"^# (\d+) in (\d+) repositories", simaticml.KEPT.read_text("utf-8"), re.MULTILINE
    )[0]
    assert int(count) >= 800
    assert int(repositories) >= 30
    documents = simaticml.read()["Document", "Engineering", "version", "version"]
    assert sum(documents.values()) == int(count)


def test_anyone_can_measure_a_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A folder of repositories: how many documents, of which kind and version, and what is new in them."""
    (tmp_path / "one").mkdir()
    (tmp_path / "one" / "secret block.xml").write_text(DOCUMENT, "utf-8")
    (tmp_path / "one" / "other.xml").write_text("<project />", "utf-8")
    assert main([str(tmp_path), "--part", "simaticml"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == "SimaticML: 1 documents in 1 repositories"
    assert "       1 SW.Blocks.FC" in lines
    assert lines[-1] == "  1 other XML files"


def test_what_is_kept_is_read_again(tmp_path: Path) -> None:
    """The table is text: a line each, sorted."""
    (tmp_path / "one").mkdir()
    (tmp_path / "one" / "a.xml").write_text(DOCUMENT, "utf-8")
    found = simaticml.summary(tmp_path)
    simaticml.write(found, tmp_path / "kept.tsv")
    assert simaticml.read(tmp_path / "kept.tsv") == found.found

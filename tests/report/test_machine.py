"""Machine formats: structure by hand, the standards' own rules where they have some."""

import importlib.util
import json
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from plcgen import __version__
from plcgen.base.diagnostics import Diagnostic, Severity, Span
from plcgen.base.display.results import Findings
from plcgen.base.display.table import csv_table, markdown_table
from plcgen.base.display.view import PLAIN
from plcgen.report.formats.sarif import uri
from plcgen.report.registry import output_format

_spec = importlib.util.spec_from_file_location("results", Path(__file__).with_name("results.py"))
results = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(results)


def findings(format_, *subjects, **more):
    """What check found, in a format."""
    return output_format(format_).render("findings", Findings("check", subjects, more), PLAIN)


def verification(format_, result):
    """A verification in a format."""
    return output_format(format_).render("verification", result, PLAIN)


def test_json_of_diagnostics():
    """Every field of a diagnostic is there under a stable key; more keys are the verb's."""
    data = json.loads(findings("json", ("x", [results.LIMIT, results.WARNING]), specs=["x"]))
    assert data == {
        "tool": "plcgen",
        "version": __version__,
        "format": 1,
        "kind": "check",
        "ok": False,
        "summary": {"errors": 1, "warnings": 1, "notes": 0},
        "diagnostics": [
            {
                "code": "PG209",
                "severity": "error",
                "message": "P50303 = 700 is outside its limits 0..650 s",
                "file": "specs/x.yaml",
                "line": 3,
                "column": 9,
                "end_line": 3,
                "end_column": 14,
                "help": "the drive would answer error 02h",
                "notes": [
                    {
                        "message": "first use",
                        "file": "specs/x.yaml",
                        "line": 1,
                        "column": 1,
                        "end_line": 1,
                        "end_column": 4,
                    }
                ],
            },
            {
                "code": "PG310",
                "severity": "warning",
                "message": "a timeout of 1 ms",
                "file": "specs/x.yaml",
                "help": "",
                "notes": [],
            },
        ],
        "specs": ["x"],
    }


def test_json_of_a_verification():
    """Groups and checks in order; a diagnostic of a check is not repeated at the end."""
    data = json.loads(verification("json", results.VERIFICATION))
    assert data["ok"] is False
    assert data["summary"] == {"error": 1, "not_run": 1, "ok": 1}
    assert [c["id"] for g in data["groups"] for c in g["checks"]] == ["layout.DB3", "layout.DB6", "run"]
    assert data["groups"][0]["checks"][1]["diagnostic"]["code"] == "PG209"
    assert data["diagnostics"] == []


def test_sarif_of_diagnostics():
    """SARIF 2.1.0: rules from the code table, results that point at them, places in characters."""
    log = json.loads(findings("sarif", ("x", [results.LIMIT, results.WARNING, results.LIMIT])))
    assert (log["version"], log["$schema"]) == ("2.1.0", "https://json.schemastore.org/sarif-2.1.0.json")
    (run,) = log["runs"]
    assert run["columnKind"] == "unicodeCodePoints"
    driver = run["tool"]["driver"]
    assert driver["name"] == "plcgen"
    rules = driver["rules"]
    assert [rule["id"] for rule in rules] == ["PG209", "PG310"]
    assert all(rule["help"]["text"] and rule["shortDescription"]["text"] for rule in rules[:1])
    assert len(run["results"]) == 2
    first, second = run["results"]
    assert (first["ruleId"], first["level"]) == ("PG209", "error")
    assert rules[first["ruleIndex"]]["id"] == first["ruleId"]
    place = first["locations"][0]["physicalLocation"]
    assert place["artifactLocation"] == {"uri": "specs/x.yaml"}
    assert place["region"] == {"startLine": 3, "startColumn": 9, "endLine": 3, "endColumn": 14}
    assert first["relatedLocations"][0]["message"] == {"text": "first use"}
    assert second["level"] == "warning"
    assert second["locations"][0]["physicalLocation"]["region"] == dict.fromkeys(place["region"], 1)  # GitHub wants one


def test_sarif_of_a_verification():
    """A failed check appears once: as its diagnostic if it has one."""
    (run,) = json.loads(verification("sarif", results.VERIFICATION))["runs"]
    assert [r["ruleId"] for r in run["results"]] == ["PG209"]


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("specs/x.yaml", "specs/x.yaml"),
        ("my specs\\é#1.yaml", "my%20specs/%C3%A9%231.yaml"),
        ("C:\\plc\\x.yaml", "file:///C:/plc/x.yaml"),
        ("/tmp/x.yaml", "file:///tmp/x.yaml"),
    ],
)
def test_uri(path, expected):
    """Paths of both systems become URI references (RFC 3986)."""
    assert uri(path) == expected


def test_github_annotations():
    """Properties and message are escaped as the workflow commands ask."""
    tricky = Diagnostic("PG101", "50% a b", Span("a,b:c.yaml", 2, 3, 4, 1), Severity.NOTE)
    assert findings("github", ("x", [results.LIMIT, tricky])) == (
        "::error file=specs/x.yaml,line=3,col=9,endColumn=14,title=PG209::"
        "P50303 = 700 is outside its limits 0..650 s%0Ahelp: the drive would answer error 02h"
        "%0Aspecs/x.yaml:1:1: first use\n"
        "::notice file=a%2Cb%3Ac.yaml,line=2,endLine=4,col=3,title=PG101::50%25 a b\n"
    )
    assert verification("github", results.VERIFICATION).count("::error") == 1


def test_junit_of_a_verification():
    """One case a check, failures and skips counted, names from the ids."""
    root = ET.fromstring(verification("junit", results.VERIFICATION))  # our own output
    assert root.attrib == {"name": "plcgen verify specs/x.yaml", "tests": "3", "failures": "1", "errors": "0"}
    cases = [(c.get("classname"), c.get("name"), [e.tag for e in c]) for c in root.iter("testcase")]
    assert cases == [
        ("plcgen.verify.layout", "layout.DB3", []),
        ("plcgen.verify.layout", "layout.DB6", ["failure"]),
        ("plcgen.verify.execution", "run", ["skipped"]),
    ]
    suites = [(s.get("name"), s.get("tests"), s.get("failures"), s.get("skipped")) for s in root]
    assert suites == [("layout", "2", "1", "0"), ("execution", "1", "0", "1")]


def test_junit_of_check_is_valid_xml_for_any_text():
    """One case a spec; control characters and markup do not break the file; warnings do not fail it."""
    bad = Diagnostic("PG101", 'a<b>&"', Span("x\x1b\ud800\n.yaml"))
    text = findings("junit", ("a.yaml", [bad]), ("b.yaml", [results.WARNING]), ("c.yaml", []))
    root = ET.fromstring(text)  # our own output
    assert [[e.tag for e in case] for case in root.iter("testcase")] == [["failure"], ["system-out"], []]
    failure = next(root.iter("failure"))
    assert failure.get("message") == 'a<b>&"'
    assert failure.text.startswith("x\ufffd\ufffd\n.yaml: error[PG101]")
    assert (root.get("tests"), root.get("failures")) == ("3", "1")


def test_formats_are_deterministic():
    """The same result gives the same bytes."""
    for format_ in ("json", "sarif", "junit", "github"):
        assert verification(format_, results.VERIFICATION) == verification(format_, results.VERIFICATION)


def test_tables():
    """Markdown escapes its own characters, CSV quotes and defuses formulas but not numbers."""
    assert markdown_table(("a|b", "n"), [("x_<y>", "1")], right=frozenset({1})) == [
        "| a\\|b | n |",
        "|---|---:|",
        "| x_&lt;y> | 1 |",
    ]
    assert csv_table(("a", "b"), [('say "x"', "-1.5"), ("=1+1", "a,b"), ("@x", "+y")]) == (
        'a,b\n"say ""x""",-1.5\n\'=1+1,"a,b"\n\'@x,\'+y\n'
    )

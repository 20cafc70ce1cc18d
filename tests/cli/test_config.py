"""``plcgen.toml``: defaults that the command line overrides, and every mistake in them at its place."""

import json
from typing import get_args

import pytest

from plcgen.base.diagnostics import Report
from plcgen.base.files.toml import parse_toml
from plcgen.cli.config import STRICTEST, Config, FailOn, find_config, weakened
from plcgen.cli.main import cli
from plcgen.cli.options import CONFIGURED
from plcgen.report.registry import formats_for

FULL = """\
specs = ["job.yaml"]
strict = true
[verify]
faults = "none"
[diff]
fail-on = "never"
policy = ["member-comment=breaking"]
[lock]
file = "layout.lock.json"
fail-on = "breaking"
"""


@pytest.fixture
def configured(tmp_path, good):
    """A folder with a spec and defaults."""
    (tmp_path / "plcgen.toml").write_text(FULL, "utf-8")
    return good


@pytest.mark.slow
def test_verbs_without_paths(plcgen, configured):
    """The specs of the file are taken, with its options; a path of the command line counts instead."""
    assert plcgen("check").err == f"no problems in {configured}\n"
    assert plcgen("generate", "-q").code == 0
    report = json.loads(plcgen("verify", "--json").out)
    runs = [check for group in report["groups"] for check in group["checks"] if check["id"].startswith("faults")]
    assert {check["outcome"] for check in runs} <= {"not run"}
    assert plcgen("check", "no.yaml").code == 1
    assert plcgen("verify", "--faults", "bad").code == 2


def test_strict(plcgen, configured, tmp_path):
    """What is a warning elsewhere is an error in this repository."""
    spec = tmp_path / configured
    spec.write_text(spec.read_text("utf-8").replace("P50303", "P922"), "utf-8")
    assert plcgen("check").code == 1
    (tmp_path / "plcgen.toml").unlink()
    assert plcgen("check", configured).code == 0


def test_diff_and_lock(plcgen, configured, tmp_path):
    """Class of change, policy and the name of the lock."""
    block = 'DATA_BLOCK "B"\nSTRUCT\n  a : Word; // x\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
    (tmp_path / "old.db").write_text(block, "utf-8")
    (tmp_path / "new.db").write_text(block.replace("// x", "// y"), "utf-8")
    changed = plcgen("diff", "old.db", "new.db")
    assert (changed.code, "breaking" in changed.out) == (0, True)
    assert plcgen("diff", "old.db", "new.db", "--fail-on", "breaking").code == 1
    assert plcgen("lock", "old.db").err == "wrote layout.lock.json, 1 block\n"
    assert (tmp_path / "layout.lock.json").is_file()
    assert configured


def test_without_a_path_and_without_a_file(plcgen):
    """It is wrong use."""
    for verb in ("check", "generate", "verify"):
        result = plcgen(verb)
        assert result.code == 2
        assert 'set "specs" in plcgen.toml' in result.err


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("specs = 5\n", [("PG106", 1, 9, 'expected a list instead of "5"')]),
        ('specs = ["../x"]\n', [("PG107", 1, 9, "../x is not below the folder of plcgen.toml")]),
        ('[lock]\nfile = "/etc/x"\n', [("PG107", 2, 8, "/etc/x is not below the folder of plcgen.toml")]),
        ('strct = true\n\n[verify]\nfaults = "all"\n', [
            ("PG104", 1, 1, 'unknown key "strct" in plcgen.toml'),
            ("PG107", 4, 10, '"all" is not a value of "faults"'),
        ]),
        ("a = \n", [("PG101", 1, 5, "invalid value")]),
        ("specs = [", [("PG101", 1, 1, "invalid value")]),
    ],
)  # fmt: skip
def test_mistakes(plcgen, tmp_path, text, expected):
    """Everything in one run, at line and column; help is given all the same."""
    (tmp_path / "plcgen.toml").write_text(text, "utf-8")
    result = plcgen("check")
    assert result.code == 1
    for code, line, column, message in expected:
        assert f"error[{code}]: {message}\n --> plcgen.toml:{line}:{column}\n" in result.err
    assert result.err.count("error[") == len(expected)


def test_help_in_the_language_of_the_file(plcgen, tmp_path):
    """TOML has no words without quotes."""
    (tmp_path / "plcgen.toml").write_text('[lock]\npolicy = "p.yaml"\n', "utf-8")
    assert 'help: write ["p.yaml"]' in plcgen("lock", "--check").err
    assert plcgen("check", "-h").code == 0
    assert plcgen("explain", "PG101").code == 0


def test_where_it_is_looked_for(tmp_path):
    """In the folder and above it as far as the repository goes; outside of one in the folder only."""
    inner = tmp_path / "repo" / "hall" / "line"
    inner.mkdir(parents=True)
    for folder in (tmp_path, tmp_path / "repo" / "hall"):
        (folder / "plcgen.toml").write_text("", "utf-8")
    assert find_config(inner) is None
    (tmp_path / "repo" / ".git").mkdir()
    assert find_config(inner) == tmp_path / "repo" / "hall" / "plcgen.toml"
    (tmp_path / "repo" / "hall" / "plcgen.toml").unlink()
    assert find_config(inner) is None


def test_toml_becomes_nodes():
    """Tables, keys with quotes, and the place of what a line shows."""
    node = parse_toml('"a b" = 1\n[t]\n  x = [1, 2]\n  y = {z = true}\n', "f", Report())
    assert node.data() == {"a b": 1, "t": {"x": (1, 2), "y": {"z": True}}}
    assert (node.key_span("a b").line, node.key_span("a b").column) == (1, 1)
    assert (node.find(["t", "x"]).span.line, node.find(["t", "x"]).span.column) == (3, 7)
    assert node.find(["t", "y", "z"]).span.line == 4
    deep = Report()
    parse_toml("a = " + "[" * 100_000, "f", deep)
    assert deep.has_errors


NO_FAULTS = (
    '[verify]\nfaults = "none"\n',
    'no faults are tried: faults is "none" instead of "quick"',
    "--faults quick",
)
POLICY = ("policy = ['type-changed=documentation']\n", "classified by a policy", "--policy member-moved=breaking")
WEAK = {
    "verify": NO_FAULTS,
    "review": NO_FAULTS,
    "diff": ('[diff]\nfail-on = "never"\n', 'fail-on is "never" instead of "breaking"', "--fail-on breaking"),
    "lock": ('[lock]\nfail-on = "compatible"\n', 'fail-on is "compatible" instead of "any"', "--fail-on any"),
    "diff ": (f"[diff]\n{POLICY[0]}", *POLICY[1:]),
    "lock ": (f"[lock]\n{POLICY[0]}", *POLICY[1:]),
}
"""Verb (with a blank where there is more than one), what weakens it, what is said, the option that overrides it."""
KIND = {"verify": "verification", "review": "review", "diff": "comparison", "lock": "comparison"}
ARGS = {"verify": ["job.yaml"], "review": ["job.yaml"], "diff": ["old.db", "new.db"], "lock": ["new.db", "--check"]}


@pytest.fixture
def judged(plcgen, good, tmp_path):
    """A repository with everything that the verbs look at."""
    block = 'DATA_BLOCK "B"\nSTRUCT\n  a : Word;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'
    (tmp_path / "old.db").write_text(block, "utf-8")
    (tmp_path / "new.db").write_text(block.replace("Word", "Int"), "utf-8")
    assert plcgen("generate", good, "-q").code == 0
    assert plcgen("lock", "old.db", "-q", "--out", "plcgen.lock.json").code == 0
    return tmp_path


@pytest.mark.slow
@pytest.mark.parametrize("weak", WEAK)
def test_what_the_repository_weakens_is_shown(plcgen, judged, weak):
    """In every format of the verb, with the line of plcgen.toml; not if the command line decides."""
    text, message, option = WEAK[weak]
    verb = weak.strip()
    (judged / "plcgen.toml").write_text(text, "utf-8")
    formats = list(formats_for(KIND[verb]))
    for format_ in formats:
        result = plcgen(verb, *ARGS[verb], "-f", format_)
        told = result.out if format_ not in {"text", "markdown"} or verb == "review" else result.out + result.err
        assert "PG903" in told, format_
        assert message in told.replace("\n", " ").replace("\\", "").replace("&#34;", '"').replace("&quot;", '"'), (
            format_
        )
        assert "plcgen.toml" in told, format_
    mine = plcgen(verb, *ARGS[verb], "-f", formats[-1], *option.split())
    assert "PG903" not in mine.out + mine.err
    quiet, plain = plcgen(verb, *ARGS[verb], "-q"), plcgen(verb, *ARGS[verb])
    assert "warning[PG903]" in quiet.err + quiet.out
    assert "plcgen.toml:2:" in plain.err + plain.out


def test_what_asks_for_more_is_not_mentioned():
    """A repository may be stricter than a verb is by itself; what it says of one verb concerns no other."""
    more = {"strict": True, "verify": {"faults": "full"}, "lock": {"fail-on": "any"}, "diff": {"fail-on": "compatible"}}
    assert [found for verb in CONFIGURED for found in weakened(Config.model_validate(more), verb)] == []
    less = Config.model_validate({"verify": {"faults": "none"}, "lock": {"fail-on": "never"}})
    assert {verb: [p for p, *_ in weakened(less, verb)] for verb in CONFIGURED} == {
        "check": [], "generate": [], "diff": [], "verify": ["faults"], "review": ["faults"], "lock": ["fail_on"],
    }  # fmt: skip


def test_every_option_that_can_be_lowered_is_known():
    """The defaults that the file is compared with are those of the verbs."""
    for verb, strictest in STRICTEST.items():
        (found,) = (p for p in cli.get_command(None, verb).params if p.name == "fail_on")
        assert (found.default, set(found.type.choices)) == (strictest, set(get_args(FailOn)))
    for verb in ("verify", "review"):
        (found,) = (p for p in cli.get_command(None, verb).params if p.name == "faults")
        assert found.default == "quick"


@pytest.mark.parametrize("name", [".cache", "cache", "/tmp/x", ""])
def test_a_repository_names_no_cache(plcgen, judged, name):
    """Its verdicts would be its own; off is one that anybody may say."""
    (judged / "plcgen.toml").write_text(f'[verify]\ncache = "{name}"\n', "utf-8")
    refused = plcgen("verify", "job.yaml", "--faults", "none")
    assert refused.code == 1
    assert (
        "error[PG107]: a repository does not say where the verdicts about it lie\n --> plcgen.toml:2:9" in refused.err
    )
    assert not (judged / ".cache").exists()
    (judged / "plcgen.toml").write_text('[verify]\ncache = "off"\n', "utf-8")
    assert plcgen("verify", "job.yaml", "--faults", "none").code == 0

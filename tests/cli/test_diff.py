"""``plcgen diff``: exit codes, streams, formats."""

import json
from xml.etree import ElementTree as ET

import pytest

from tests.cli.conftest import GOOD
from tests.report.review.reviews import git

OLD = 'DATA_BLOCK "B"\nSTRUCT\n  a : Word; // x\n  b : Word;\nEND_STRUCT;\nBEGIN\nEND_DATA_BLOCK\n'


@pytest.fixture
def versions(tmp_path):
    """Write two versions and return their names."""

    def make(*replaced):
        (tmp_path / "old.db").write_text(OLD, encoding="utf-8")
        (tmp_path / "new.db").write_text(OLD.replace(*replaced), encoding="utf-8")
        return "old.db", "new.db"

    return make


def test_text(plcgen, versions):
    """Differences are the result; a breaking one ends with 1."""
    result = plcgen("diff", *versions("  b :", "  x : Word;\n  b :"))
    assert (result.code, result.err) == (1, "")
    assert result.out == (
        'DB "B"\n'
        "  breaking       member-moved        b: moved by +2 bytes: 2.0 -> 4.0\n"
        "  compatible     block-grown         4 -> 6 bytes\n"
        "  compatible     member-added        added: x : WORD at 2.0\n"
        "\n"
        "1 breaking, 2 compatible; fails: --fail-on breaking\n"
    )
    verbose = plcgen("diff", "old.db", "new.db", "-v").out
    assert "at new.db:5:3" in verbose


def test_nothing_changed(plcgen, versions):
    """Said in one line, exit code 0."""
    result = plcgen("diff", *versions("  a", " a"))
    assert (result.code, result.out, result.err) == (0, "no semantic differences\n", "")


@pytest.mark.parametrize(
    ("args", "code"),
    [
        ((), 0),
        (("--fail-on", "compatible"), 0),
        (("--fail-on", "any"), 1),
        (("--policy", "member-comment=breaking"), 1),
        (("--policy", "member-comment=breaking", "--fail-on", "never"), 0),
    ],
)
def test_fail_on_and_policy(plcgen, versions, args, code):
    """A comment is documentation, unless someone says otherwise."""
    assert plcgen("diff", *versions("// x", "// y"), *args).code == code


def test_wrong_policy(plcgen, versions):
    """A misspelt id is told with the right one."""
    result = plcgen("diff", *versions("x", "y"), "--policy", "member-coment=breaking")
    assert (result.code, result.out) == (1, "")
    assert "error[PG631]" in result.err
    assert 'did you mean "member-comment"' in result.err


def test_formats(plcgen, versions, tmp_path):
    """JSON and SARIF own stdout, Markdown is a table; --output writes the same bytes."""
    names = versions("a : Word", "a : Int")
    data = json.loads(plcgen("diff", *names, "--json").out)
    assert (data["kind"], data["ok"], data["summary"]["breaking"]) == ("comparison", False, 1)
    assert data["changes"][0]["new_place"] == {
        "file": "new.db", "line": 3, "column": 3, "end_line": 3, "end_column": 4,
    }  # fmt: skip
    assert json.loads(plcgen("diff", *names, "-f", "sarif").out)["version"] == "2.1.0"
    markdown = plcgen("diff", *names, "-f", "markdown").out
    assert '| :red_circle: breaking | **DB "B"** | a: WORD -&gt; INT | `type-changed` |' in markdown
    plcgen("diff", *names, "-f", "markdown", "-o", "changes.md")
    assert (tmp_path / "changes.md").read_text("utf-8").startswith(markdown)


def test_wrong_use(plcgen):
    """Two versions are needed; the table of changes needs none."""
    assert plcgen("diff", "one").code == 2
    listed = plcgen("diff", "--list-changes")
    assert listed.code == 0
    assert "member-moved" in listed.out


def test_unreadable(plcgen, versions):
    """What cannot be read is no difference: it is an error."""
    result = plcgen("diff", versions("x", "y")[0], "missing.db")
    assert (result.code, result.out) == (1, "")
    assert "error[PG804]" in result.err


def test_dev_null_is_an_empty_version(plcgen, versions):
    """Git hands it over for a file that was added or removed."""
    assert "block-added" in plcgen("diff", "/dev/null", versions("x", "y")[1]).out


@pytest.mark.parametrize(
    "words",
    [
        ("diff", "old.db", "new.db", "--output", "old.db"),
        ("diff", "old.db", "new.db", "-o", "./new.db"),
        ("check", "old.db", "--output", "old.db"),
        ("check", ".", "--output", "old.db"),
        ("layout", "old.db", "--out", "old.db", "--force"),
        ("lock", "old.db", "--out", "old.db", "--force"),
        ("lock", "new.db", ".", "--out", "old.db", "--force"),
    ],
)
def test_a_source_that_is_read_is_never_overwritten(plcgen, versions, tmp_path, words):
    """Whatever is said about overwriting: it is the user's work."""
    versions("a", "a")
    result = plcgen(*words)
    assert (result.code, result.out) == (2, "")
    assert "is a source that is read: write the result elsewhere" in result.err
    assert (tmp_path / "old.db").read_text(encoding="utf-8") == OLD
    assert (tmp_path / "new.db").read_text(encoding="utf-8") == OLD


def test_a_report_beside_the_sources_is_written_again(plcgen, versions, tmp_path):
    """Pipelines write the same file every time."""
    versions("a", "a")
    for _ in range(2):
        assert plcgen("check", "old.db", "new.db", "-f", "json", "-o", "report.json").code == 0
    assert json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))["ok"] is True


def test_annotations(plcgen, versions):
    """For a pull request, the worst first: what fails the run is an error at its line, else a warning."""
    changed = versions("  b :", "  x : Word;\n  b :")
    expected = [
        ("{}", 'line=5,col=3,endColumn=4,title=member-moved::breaking: DB "B": b: moved by +2 bytes: 2.0 -> 4.0'),
        ("notice", 'line=1,col=1,endColumn=11,title=block-grown::compatible: DB "B": 4 -> 6 bytes'),
        ("notice", 'line=4,col=3,endColumn=4,title=member-added::compatible: DB "B": added: x : WORD at 2.0'),
    ]
    for fail_on, word, code in (("breaking", "error", 1), ("never", "warning", 0)):
        result = plcgen("diff", *changed, "-f", "github", "--fail-on", fail_on)
        assert result.code == code
        assert result.out.splitlines() == [f"::{word_.format(word)} file=new.db,{rest}" for word_, rest in expected]
    assert plcgen("diff", "old.db", "old.db", "-f", "github").out == ""


def test_test_cases(plcgen, versions):
    """A test case per block that changed, which fails if a change fails the run; one that passes if nothing did."""

    def cases(*args):
        root = ET.fromstring(plcgen("diff", *args, "-f", "junit").out)  # our own output
        counts = {key: root.get(key) for key in ("tests", "failures")}
        return counts, [(case.get("name"), [part.tag for part in case]) for case in root.iter("testcase")]

    changed = versions("  b :", "  x : Word;\n  b :")
    assert cases(*changed) == ({"tests": "1", "failures": "1"}, [('DB "B"', ["failure"])])
    assert cases(*changed, "--fail-on", "never") == ({"tests": "1", "failures": "0"}, [('DB "B"', ["system-out"])])
    assert cases("old.db", "old.db") == ({"tests": "1", "failures": "0"}, [("nothing changed", [])])
    assert cases("old.db", "no.db") == ({"tests": "1", "failures": "1"}, [("problems", ["failure"])])


@pytest.fixture
def commits(versions, tmp_path):
    """Two commits: in the second a job writes another value, and a member is inserted into a data block."""
    versions("", "")
    (tmp_path / "plant").mkdir()
    (tmp_path / "plant" / "job.yaml").write_text(GOOD.replace("read: [P50303]", "write: {P50304: 100.0}"), "utf-8")
    (tmp_path / "old.db").unlink()
    (tmp_path / "new.db").rename(tmp_path / "plant" / "block.db")
    git(tmp_path, "init", "--quiet")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "--quiet", "-m", "first")
    for name, old, new in (("job.yaml", "100.0", "50.0"), ("block.db", "  b :", "  x : Word;\n  b :")):
        file = tmp_path / "plant" / name
        file.write_text(file.read_text("utf-8").replace(old, new), "utf-8")
    git(tmp_path, "commit", "--quiet", "-am", "second")


WRITTEN, MOVED = "P50304 100.0 -> 50.0", "b: moved by +2 bytes"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("HEAD~1", "plant/job.yaml", WRITTEN),
        ("plant/job.yaml", "HEAD~1", "P50304 50.0 -> 100.0"),
        ("HEAD~1:plant/job.yaml", "HEAD:plant/job.yaml", WRITTEN),
        ("HEAD~1:./plant/job.yaml", "plant/job.yaml", WRITTEN),
        ("HEAD~1", "plant/block.db", MOVED),
        ("HEAD~1", "plant", MOVED),
        ("HEAD~1:plant/", "HEAD:plant", MOVED),
        ("HEAD~1:", ".", MOVED),
        ("HEAD", "plant/job.yaml", "no semantic differences"),
    ],
)
@pytest.mark.usefixtures("commits")
def test_a_revision_of_git(plcgen, old, new, said):
    """It stands for the other side as it was there; ``REV:PATH`` names a file or folder of it, as in git."""
    result = plcgen("diff", old, new)
    assert said in result.out, result
    assert result.err == ""
    assert "plcgen-base-" not in plcgen("diff", old, new, "--verbose", "--format", "json").out


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("HEAD~9", "plant/job.yaml", '"HEAD~9" is not a folder, a spec or a git revision here'),
        ("HEAD~1", "HEAD", "name one: HEAD~1:job.yaml"),
        ("HEAD~1:plant/other.yaml", "plant/job.yaml", "has no other.yaml"),
        ("HEAD~1:../../x.yaml", "plant/job.yaml", "is not in the repository"),
        ("--output=x", "plant/job.yaml", "PG901"),
        ("nothing.scl", "plant/block.db", "No such file"),
        ("HEAD~1", "", "give two versions: OLD and NEW, for example plcgen diff HEAD~1 job.yaml"),
    ],
)
@pytest.mark.usefixtures("commits")
def test_no_such_revision(plcgen, old, new, said):
    """The message names the form that works."""
    result = plcgen("diff", *filter(None, (old, new)))
    assert result.code in {1, 2}
    assert said in " ".join(result.err.split())

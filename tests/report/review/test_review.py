"""The review page: what stands on it, against what it compares, what it does with hostile texts."""

from __future__ import annotations

import dataclasses
import html.parser
import json
import re
import shutil
import tomllib

import pytest

from plcgen import api
from plcgen.base.diagnostics import DiagnosticError
from plcgen.build.sheet import Role
from plcgen.ds47.sheet import review_sheet
from plcgen.proof.checks import Check, CheckGroup, Outcome, Trial, Verification
from plcgen.proof.ledger import Grade
from plcgen.report.review.grid import matrix, scenario_grids
from plcgen.report.review.markdown import LIMIT
from plcgen.report.review.page import PARTS, ROLES
from plcgen.report.review.timeline import time_line
from plcgen.report.trace.model import JobResult, Trace
from tests.projects import FAQ, ROOT, generated_example, per_block
from tests.report.review.reviews import LONG, faq_review, git, hostile_review, ppi_review, show


def test_the_write_list_says_what_the_spec_says():
    """P50304 := 100.0 s, started by M150.0: the spec of the FAQ. Type and limits of the catalogue were not read."""
    (entry,) = faq_review().sheet.writes
    assert (entry.job, entry.partners, entry.parameter) == ("write_ramp_down", ("dcm",), "P50304")
    assert (entry.value, entry.input, entry.limits, entry.unit) == ("100.0", False, "", "s")
    assert (entry.trigger, entry.danger) == ("M150.0", "")
    assert [doubt.split(":")[0] for doubt in entry.doubts] == ["type inferred, not read in a manual", "limits 0 .. 650"]
    assert "not read in a manual" in show("html", faq_review())


def test_values_that_come_from_a_record_or_a_clock_are_no_inputs():
    """What a recipe or the time gives is not said to be written if nothing is connected."""
    for name, key, said in (
        ("s7-1200_s120_recipe", "load_winding", "a record of RecipeWinding, chosen by recordNumber"),
        ("s7-1500_s120_save", "set_clock", "made of the time at the input utc"),
    ):
        project = api.check(ROOT / "specs" / f"{name}.yaml").project
        (plan,) = project.plans
        entries = [entry for entry in review_sheet(plan).writes if entry.job == key and not entry.value.isdigit()]
        assert entries
        assert {(entry.value, entry.input) for entry in entries} == {(said, False)}


def test_what_starts_something_is_not_said_to_be_lost():
    """p3981 acknowledges and p0977 saves; the fixed value p2900 is a setting in RAM."""
    said = {}
    for name in ("s7-1500_s120_messages", "s7-1500_s120_save"):
        (plan,) = api.check(ROOT / "specs" / f"{name}.yaml").project.plans
        said |= {entry.parameter: entry.memory for entry in review_sheet(plan).writes}
    assert said["P3981"] == "starts something, keeps no value"
    assert said["P977"] == "copies RAM to non-volatile memory"
    assert said["P2900"] == "RAM, lost at power-off"


def test_a_request_is_the_telegram_of_the_faq_byte_by_byte():
    """FAQ 109750712 figure 5-1: 03 01 02 01 10 01 C4 7F 00 00; the worst answer is 4 + 6 * 1 bytes."""
    exchange = faq_review().sheet.exchanges[0]
    sent = [byte for field in exchange.request.fields for byte in field.data]
    assert bytes(sent).hex(" ").upper() == "03 01 02 01 10 01 C4 7F 00 00"
    good, bad = exchange.answers
    assert [byte for field in good.fields for byte in field.data] == [None, 1, 2, 1, 8, 1, None, None, None, None]
    assert [byte for field in bad.fields for byte in field.data] == [None, 0x81, 2, 1, 0x44, 2, None, None, None, None]
    assert [field.address for field in exchange.request.fields][-2:] == ["DB3.DBW6", "DB3.DBW8"]
    assert {field.role for field in bad.fields} == {Role.HEADER, Role.ERROR}


def test_every_member_of_the_request_leads_to_its_line():
    """The start values of DB3 stand in the one source, at the lines that are named."""
    review = faq_review()
    (excerpt,) = (e for e in review.excerpts if e.block == "WR_DataBuffer")
    lines = (generated_example(FAQ.stem) / excerpt.file).read_text("utf-8-sig").splitlines()
    assert {line.member for line in excerpt.lines} == {0, 1, 2, 3, 4, 5, 6, 8}
    assert all(lines[line.number - 1].strip() == line.text for line in excerpt.lines)


def test_a_run_without_and_with_the_fault_is_recorded_for_every_job():
    runs = [(run.job, run.fault, run.trace.jobs[0].ending) for run in faq_review().runs]
    assert runs == [
        (job, fault, "done") for job in ("read_ramp_up", "write_ramp_down") for fault in ("", "busy:times=2")
    ]
    assert [run.trace.jobs[0].retries for run in faq_review().runs] == [0, 2, 0, 2]


def test_the_runs_of_a_serial_line_are_recorded_too():
    """Every job once as it is and once with an answer that is lost: the request is repeated once."""
    runs = [(run.job, run.fault, run.trace.jobs[0].ending, run.trace.jobs[0].retries) for run in ppi_review().runs]
    assert len(runs) == 16
    assert runs[:2] == [("line.read_all", "", "done", 0), ("line.read_all", "silence", "done", 1)]
    assert {ending for _, _, ending, _ in runs} == {"done"}
    assert not [sentence for sentence in ppi_review().missing if "run" in sentence]
    page = show("html", ppi_review())
    assert "contacts with the s7_200" not in page
    assert "4 contacts with the station" in page
    assert ">P_RCV_RK</text>" in page


def test_the_page_says_what_is_not_there():
    page = show("html", faq_review())
    for sentence in ("nothing to compare with was named", "there is no plcgen.lock.json"):
        assert sentence in page
    assert "in order as far as it was run" in page


@pytest.mark.parametrize("format_", ["html", "markdown"])
def test_the_page_says_what_the_result_rests_on(format_):
    """Every assumption of the report, the worst known first; the FAQ is what its telegrams rest on."""
    review = faq_review()
    assert sorted(map(str, review.assumptions)) == sorted(map(str, review.verification.ledger))
    order = ["general knowledge", "spec", "second source", "observed", "manual"]
    places = [order.index(one.grade.value) for one in review.assumptions]
    assert places == sorted(places)
    page = show(format_, review)
    assert "figure 5-1: DB3 and DB4" in page
    assert f"{len(review.assumptions)} assumptions" in page


def test_the_page_needs_nothing_and_permits_its_own_script_only():
    """No address, and a policy with the hash of the one script."""
    page = show("html", faq_review())
    assert not re.search(r"(?:src|href)\s*=\s*[\"'](?!#)", page)
    assert set(re.findall(r"url\([^)]*\)", page)) <= {"url(#hatch)"}
    policy = re.search(r'Content-Security-Policy" content="([^"]+)"', page)
    assert policy
    assert policy[1].startswith("default-src 'none'")
    assert "unsafe-inline" not in policy[1].split("script-src")[1]
    assert len(re.findall("<script", page)) == 1


class _Tags(html.parser.HTMLParser):
    def __init__(self):
        super().__init__()
        self.seen = set()
        self.handlers = []

    def handle_starttag(self, tag, attrs):
        self.seen.add(tag)
        self.handlers += [name for name, _ in attrs if name.startswith("on")]


@pytest.mark.slow
def test_texts_of_a_spec_are_texts(tmp_path):
    """Markup in names, titles, units and comments is shown, not obeyed: in HTML and in Markdown."""
    review = hostile_review(tmp_path)
    page = show("html", review)
    tags = _Tags()
    tags.feed(page)
    assert "img" not in tags.seen
    assert tags.handlers == []
    assert page.count("<script") == 1
    assert "&lt;img src=x onerror=alert(2)&gt;" in page
    text = show("markdown", review)
    assert "<img" not in text
    assert "<script" not in text
    assert LONG in text


def test_markdown_is_bounded_and_begins_with_the_verdict():
    """A comment of GitHub takes 65,536 characters. 2,000 writes do not fit: how many are left out is said."""
    review = faq_review()
    text = show("markdown", review)
    assert text.startswith("### Review of S7-300")
    assert text.index("Write list") < text.index("Fault matrix") < text.index(" files</summary>")
    many = dataclasses.replace(review.sheet, writes=review.sheet.writes * 2000)
    long = show("markdown", dataclasses.replace(review, sheet=many))
    assert len(long.encode()) <= LIMIT
    assert re.search(r"Left out for its length: .*Write list \(\d+ of 2000 lines\)", long)


def test_json_has_the_bytes_and_the_verdict():
    data = json.loads(show("json", faq_review()))
    assert (data["kind"], data["ok"], len(data["files_sha256"])) == ("review", True, 64)
    assert [b for f in data["telegrams"][0]["answers"][0]["fields"] for b in f["bytes"]][:4] == [None, 1, 2, 1]


@pytest.fixture
def repository(tmp_path):
    """A repository with the spec of the FAQ and its files, the spec then changed: 100.0 becomes 50.0."""
    (tmp_path / "job.yaml").write_text(per_block(FAQ.read_text("utf-8")), "utf-8")
    assert api.generate(tmp_path / "job.yaml", tmp_path / "plc").ok
    assert api.lock(tmp_path / "plc" / "db", out=tmp_path / "plcgen.lock.json").ok
    git(tmp_path, "init", "--quiet")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "--quiet", "-m", "first")
    text = (tmp_path / "job.yaml").read_text("utf-8")
    (tmp_path / "job.yaml").write_text(text.replace("P50304: 100.0", "P50304: 50.0"), "utf-8")
    assert api.generate(tmp_path / "job.yaml", tmp_path / "plc").ok
    return tmp_path


@pytest.mark.slow
def test_against_a_revision(repository):
    """The telegram writes another value, the start value of DB5 too; the lock has not been written again."""
    review = api.review(repository / "job.yaml", repository / "plc", against="HEAD", faults="none")
    kinds = {title: {change.kind for change in found.changes} for title, found in review.changes}
    assert "telegram-value" in kinds["the spec and what follows from it"]
    assert "start-value" in kinds["the generated sources on disk"]
    assert kinds["the layout lock"] == set()
    assert review.lock is not None
    assert {change.kind for change in review.lock.changes} == {"start-value"}
    assert not review.ok
    changed = [pair.after.name for pair in review.layouts if pair.changed]
    assert changed == ["WR_DataBuffer_1"]
    assert review.base.startswith("HEAD (")
    assert "/plcgen-base-" not in show("html", review) + show("markdown", review) + show("json", review)


@pytest.mark.slow
def test_what_changed_stands_first(repository):
    """Of a review against something: the sentence of a job, on the page and as Markdown; its tables are not printed."""
    said = "P50304 100.0 -&gt; 50.0"
    for against, titles in (("HEAD", ["1 What changed", "2 Verdict"]), ("", ["1 Verdict", "2 What changed"])):
        review = api.review(repository / "job.yaml", repository / "plc", against=against, faults="none")
        page, text = show("html", review), show("markdown", review)
        assert re.findall(r"<h2>(.*?)</h2>", page)[:2] == titles
        links = re.findall(r'<a href="#\w+">(\d&nbsp;[\w ]+)</a>', page)[:2]
        assert [link.replace("&nbsp;", " ") for link in links] == titles
        if against:
            assert re.sub("<wbr>", "", page).index(said) < page.index("Verdict</h2>")
            section = re.search(r'<section id="changes">(.*?)</section>', page, re.DOTALL)[1]
            fronts = re.findall(r'(</summary>)?\s*<div class="scroll"><table', section)
            assert [bool(front) for front in fronts] == [True, True, False]  # spec, sources; the lock is an error
            assert text.index("Changes: the spec") < text.index("Write list")


@pytest.mark.slow
def test_against_a_folder_and_a_spec(repository, tmp_path_factory):
    """A folder with a spec of the same name is compared as a spec, one with sources alone as sources."""
    before = tmp_path_factory.mktemp("before")
    (before / "job.yaml").write_text(git(repository, "show", "HEAD:job.yaml"), "utf-8")
    for against in (before, before / "job.yaml"):
        review = api.review(repository / "job.yaml", repository / "plc", against=str(against), faults="none")
        assert [title for title, _ in review.changes] == ["the spec and what follows from it"]
        assert "telegram-value" in {change.kind for _, found in review.changes for change in found.changes}
    review = api.review(repository / "job.yaml", repository / "plc", against=str(repository / "plc"), faults="none")
    assert [(title, found.changes) for title, found in review.changes] == [("the generated sources on disk", ())]


@pytest.mark.slow
def test_a_link_in_a_revision_is_not_followed(repository):
    """A commit may hold a link to anywhere; of a revision only regular files are read."""
    (repository / "evil.yaml").symlink_to("/etc/passwd")
    git(repository, "add", "evil.yaml")
    git(repository, "commit", "--quiet", "-m", "a link")
    review = api.review(repository / "job.yaml", repository / "plc", against="HEAD", faults="none")
    assert all(found.readable for _, found in review.changes)


@pytest.mark.parametrize("against", ["no-such-thing", "--output=x", "HEAD:job.yaml", "-h"])
def test_a_base_that_does_not_exist(repository, against):
    with pytest.raises(DiagnosticError) as problem:
        api.review(repository / "job.yaml", repository / "plc", against=against, faults="none")
    assert [d.code for d in problem.value.diagnostics] == ["PG901"]
    assert sorted(path.name for path in repository.iterdir()) == [".git", "job.yaml", "plc", "plcgen.lock.json"]


def test_a_broken_file_makes_a_page_that_says_so(tmp_path):
    """One byte of the request DB on disk: C47F becomes C47E."""
    shutil.copytree(generated_example(FAQ.stem), tmp_path / "plc")
    (source,) = (tmp_path / "plc").glob("*.scl")
    source.write_bytes(source.read_bytes().replace(b"C47F", b"C47E"))
    review = api.review(FAQ, tmp_path / "plc", faults="none")
    assert not review.ok
    page = show("html", review)
    assert "not in order" in page
    assert "PG6" in page


def test_a_spec_that_is_not_there_makes_a_page_too(tmp_path):
    review = api.review(tmp_path / "none.yaml", tmp_path / "plc")
    assert not review.ok
    assert "not in order" in show("html", review)
    assert ":x:" in show("markdown", review)


def test_nothing_is_said_of_a_spec_with_errors(repository):
    """A family that does not exist: what the blocks write is not known, so no text says that they write nothing."""
    spec = repository / "job.yaml"
    spec.write_text(spec.read_text("utf-8").replace("family: s7", "family: s7-14.0 # s7", 1), "utf-8")
    review = api.review(spec, repository / "plc", against="HEAD", faults="none")
    for text in (show("html", review), show("markdown", review)):
        assert "write nothing" not in text
        assert "Not known: the spec has errors." in text
        assert "no differences" not in text


def test_the_verdict_names_a_lock_that_differs(repository):
    """Start value 100.0 of WR_DataBuffer_1 in the lock, 50.0 in the sources: the verdict says so, and where."""
    review = api.review(repository / "job.yaml", repository / "plc", faults="none")
    page, text = re.sub("<wbr>", "", show("html", review)), show("markdown", review)
    section = re.search(r'<section id="verdict">(.*?)</section>', page, re.DOTALL)[1]
    for shown in (section, text.partition("### ")[2].partition("### ")[0]):
        assert "differs from the sources" in shown
        assert "plcgen.lock.json" in shown
        assert "WR_DataBuffer_1" in shown.replace("\\", "")


def test_a_lock_outside_of_the_repository_is_named(repository, tmp_path_factory):
    """Not --against, which is right, but --lock is what git does not have."""
    old = tmp_path_factory.mktemp("elsewhere") / "old.lock.json"
    shutil.copy(repository / "plcgen.lock.json", old)
    with pytest.raises(DiagnosticError) as problem:
        api.review(repository / "job.yaml", repository / "plc", against="HEAD", lock=old, faults="none")
    (found,) = problem.value.diagnostics
    assert (found.code, found.span.file) == ("PG901", f"--lock {old.as_posix()}")
    assert "outside the repository" in found.message
    assert "plcgen lock --check" in found.help


@pytest.mark.slow
def test_the_page_is_the_same_every_time():
    assert show("html", faq_review()) == show("html", api.review(FAQ, generated_example(FAQ.stem), faults="none"))


@pytest.mark.slow
def test_instances_of_a_plant_are_a_table():
    """20 drives with 3 jobs: 3 shapes, 60 instances, one row for each parameter that is written."""
    spec = FAQ.with_name("s7-300_plant_v5.yaml")
    review = api.review(spec, generated_example(spec.stem), faults="none")
    sheet = review.sheet
    assert (len(sheet.exchanges), len(sheet.instances), len(sheet.writes)) == (3, 60, 2)
    assert len(sheet.writes[0].partners) == 20
    assert len(review.runs) == 6
    assert len(show("html", review).encode()) < 400_000


def test_ppi_jobs_are_reviewed():
    """RUN and STOP of a station are dangerous and signed off by their keys; what the result rests on is said."""
    review = ppi_review()
    assert not any("ledger" in sentence for sentence in review.missing)
    assert "manual CP 341" in show("html", review)
    assert [one.subject for one in review.assumptions].count("layout") == 1
    assert all(entry.danger for entry in review.sheet.writes if entry.parameter == "CPU")
    signed = {entry.signed for entry in review.sheet.writes if entry.parameter == "CPU"}
    assert signed == {"by the key run of the job", "by the key stop of the job"}
    assert "not signed off in the spec" not in show("html", review)


def test_one_scan_is_one_scan():
    """A job that ends in the scan in which it starts: a value of its record is not allowed."""
    job = JobResult("load", "s120", "error", 0x8501, "record", 1, 10, 1, 1, 0, "", ())
    line = time_line(Trace("job.yaml", "job_generated", scans=1, time=10, jobs=(job,)), job)
    assert line.summary == "error 16#8501: record; 1 scan, 10 ms; 1 telegram; 1 retry"
    check = Check("faults.a", "faults a", "", Outcome.OK, "ok", trials=(Trial("values", 1, ok=True),))
    (grid,) = scenario_grids(Verification("s", "f", "p", "t", (CheckGroup("execution", "Execution", (check,)),), ()))
    assert grid.rows == (("values", (("ok", "1 scan"),)),)


def test_no_check_hides_another_in_the_fault_matrix():
    """Telegrams of two jobs, and jobs of one name on two lines, have rows of their own: an error stays to be seen."""
    bad, good = Outcome.ERROR, Outcome.OK
    checks = [
        Check("telegram.A_Request1", "a 1/2", "", bad, "byte 6 differs"),
        Check("telegram.B_Request1", "b 1/2", "", good, "ok"),
        Check("drive.A_Request1", "answer a 1/2", "", good, "ok"),
        Check("run.a", "run a", "", good, "ok"),
        Check("run.north.level", "run level", "", bad, "hangs"),
        Check("run.south.level", "run level", "", good, "ok"),
    ]
    grid = matrix(Verification("s", "f", "p", "t", (CheckGroup("execution", "Execution", tuple(checks)),), ()))
    assert grid.columns == ("telegram", "answer", "run")
    assert grid.rows == (
        ("a 1/2", (("error", "byte 6 differs"), ("ok", "ok"), None)),
        ("b 1/2", (("ok", "ok"), None, None)),
        ("a", (None, None, ("ok", "ok"))),
        ("level", (None, None, ("error", "hangs"))),
        ("level", (None, None, ("ok", "ok"))),
    )


def test_scenarios_stand_in_grids():
    """A row per scenario, a column per job, a few jobs in each grid; a dot where a job has no such fault."""
    both = Trial("busy twice", 12, ok=True)
    checks = [
        Check("faults.a", "faults a", "", Outcome.OK, "ok", trials=(both, Trial("values", 9, ok=True))),
        *(Check(f"faults.j{n}", f"faults j{n}", "", Outcome.OK, "ok", trials=(both,)) for n in range(5)),
        Check("faults.b", "faults b", "", Outcome.ERROR, "bad", trials=(both, Trial("lost", 30, ok=False))),
        Check("faults.c", "faults c", "", Outcome.NOT_RUN, "not asked for"),
    ]
    group = CheckGroup("execution", "Execution", tuple(checks))
    first, second = scenario_grids(Verification("s", "f", "p", "t", (group,), ()))
    assert first.jobs == ("a", "j0", "j1", "j2", "j3", "j4")
    assert first.rows == (
        ("busy twice", (("ok", "12 scans"),) * 6),
        ("values", (("ok", "9 scans"), None, None, None, None, None)),
    )
    assert (second.jobs, second.more) == (("b",), 0)
    assert second.rows[1] == ("lost", (("error", "30 scans"),))


@pytest.mark.parametrize(("language", "title"), [("en", "Write list"), ("de", "Schreibliste"), ("zh", "写入清单")])
def test_labels_are_in_the_first_language_of_the_project(language: str, title: str):
    """Headings, columns, badges and fields; what the spec, reports and telegrams say stays as it is."""
    page = show("html", dataclasses.replace(faq_review(), language=language))
    assert f'<html lang="{language}">' in page
    assert f"<h2>3 {title}</h2>" in page
    assert ("<th>job, block</th>" in page) == (language == "en")
    assert "RFG ramp-down time 1" in page


def test_every_label_has_both_languages():
    """A label of the template, and each word that the page puts into one, is in the table."""
    table = tomllib.loads((ROOT / "templates" / "html" / "review.toml").read_text("utf-8"))
    template = (ROOT / "templates" / "html" / "review.html.j2").read_text("utf-8")
    wanted = {label for pair in re.findall(r"_\(\"([^\"]+)\"\)|_\('([^']+)'\)", template) for label in pair if label}
    wanted |= (
        {title for _, title in PARTS} | {text for _, text in ROLES} | set(map(str, Outcome)) | set(map(str, Grade))
    )
    assert wanted - table.keys() == set()
    assert {label for label, said in table.items() if len(said) != 2 or not all(said)} == set()

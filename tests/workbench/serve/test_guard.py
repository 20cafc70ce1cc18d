"""Who can reach the server, and what it reads: this machine's own page, and files of the folder."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest

from tests.workbench.serve.asking import PORT, TOKEN, Server

SPEC = """\
plc: {name: Press, family: s7-1500, toolchain: tia-v19}
drives:
  axis: {device: sinamics-s120, hardware_id: 270, drive_object: 3}
jobs:
  read_speed: {drive: axis, read: [r21]}
"""
ASK = f"/{TOKEN}/ask/folder"
MIB = 1024 * 1024
"""16 of them are the most that a request may hold."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with one spec, and something beside it that is nobody's business."""
    (tmp_path / "served").mkdir()
    (tmp_path / "served" / "press.yaml").write_text(SPEC, "utf-8")
    (tmp_path / "secret.yaml").write_text("plc: {name: Secret}\n", "utf-8")
    return tmp_path / "served"


@pytest.fixture
def server(folder: Path) -> Server:
    """Its server."""
    return Server(folder)


def test_the_page_itself_is_answered(server: Server) -> None:
    """The page, its files and a question; without these the refusals below would prove nothing."""
    page = server.get(f"/{TOKEN}/")
    assert (page.status, "page/app.js" in page.text) == (200, True)
    assert server.get(f"/{TOKEN}/page/app.js").status == 200
    assert server.told("folder")["specs"] == ["press.yaml"]


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"host": f"evil.example:{PORT}"}, 421),
        ({"host": "127.0.0.1"}, 421),
        ({"host": None}, 421),
        ({"origin": "http://evil.example"}, 403),
        ({"origin": "null"}, 403),
        ({"origin": "http://127.0.0.1:1"}, 403),
        ({"origin": None}, 403),
        ({"sec-fetch-site": "cross-site"}, 403),
        ({"sec-fetch-site": "same-site"}, 403),
        ({"content-type": "text/plain"}, 415),
        ({"content-type": "application/x-www-form-urlencoded"}, 415),
        ({"content-length": str(16 * MIB + 1)}, 413),
        ({"content-length": "-1"}, 413),
    ],
)
def test_another_site_cannot_ask(server: Server, headers: dict[str, str | None], status: int) -> None:
    """A name that points here (DNS rebinding), a script of another page, a form, and more than is read."""
    answer = server.request("POST", ASK, [b"{}"], headers)
    assert (answer.status, "press" in answer.text) == (status, False)


@pytest.mark.parametrize(
    "path", ["/", "/ask/folder", "/wrong/", f"/{TOKEN[:-1]}/", f"/{TOKEN}x/", "/page/app.js", f"//{TOKEN}/", ""]
)
def test_nothing_without_the_token(server: Server, path: str) -> None:
    """Neither the page nor its files: what is not known cannot be framed or probed."""
    assert server.get(path).status == 404


def test_another_page_may_lead_here_and_do_no_more(server: Server) -> None:
    """Who has the address opens it from wherever it stands; a script or a picture of that page gets nothing."""
    assert server.get(f"/{TOKEN}/", origin=None, sec_fetch_site="cross-site", sec_fetch_mode="navigate").status == 200
    for mode in ("no-cors", "cors"):
        answer = server.get(f"/{TOKEN}/page/app.js", origin=None, sec_fetch_site="cross-site", sec_fetch_mode=mode)
        assert answer.status == 403


def test_every_answer_has_the_policy(server: Server) -> None:
    """No inline script, no frame around it, no address handed on, nothing kept."""
    for path in (f"/{TOKEN}/", f"/{TOKEN}/page/app.js", f"/{TOKEN}/nothing"):
        headers = server.get(path).headers
        policy = dict(part.strip().split(" ", 1) for part in headers["content-security-policy"].split(";"))
        assert (policy["default-src"], policy["script-src"]) == ("'none'", "'self'")
        assert policy["frame-ancestors"] == "'none'"
        assert "unsafe" not in headers["content-security-policy"]
        wanted = {"referrer-policy": "no-referrer", "x-content-type-options": "nosniff", "cache-control": "no-store"}
        assert {name: headers[name] for name in wanted} == wanted
    assert server.get(f"/{TOKEN}/", host="evil.example").headers["cross-origin-resource-policy"] == "same-origin"


def test_a_long_body_without_a_length_ends(server: Server) -> None:
    """It is counted while it comes."""
    assert server.request("POST", ASK, [b" " * MIB] * 17).status == 413


@pytest.mark.parametrize(
    "name",
    ["../secret.yaml", "/etc/passwd", "..\\secret.yaml", "C:/secret.yaml", "//host/a.yaml",
     "press.yaml/../../secret.yaml", "", ".", "nul.yaml\0", "press.txt"],
)  # fmt: skip
@pytest.mark.parametrize("question", ["read", "check", "save", "write", "new", "becomes"])
def test_no_path_outside_the_folder(folder: Path, server: Server, question: str, name: str) -> None:
    """For every question that takes a name; nothing is written either."""
    given: dict[str, Any] = {"name": name}
    given |= {} if question in {"read", "new"} else {"text": SPEC}
    given |= {"known": ""} if question in {"save", "write"} else {"given": {}} if question == "new" else {}
    before = sorted(folder.parent.rglob("*"))
    answer = server.ask(question, given)
    assert (answer.status, "Secret" in answer.text) == (422, False)
    assert sorted(folder.parent.rglob("*")) == before


@pytest.mark.skipif(os.name == "nt", reason="links need rights there")
def test_links_are_not_followed_out(folder: Path, server: Server) -> None:
    """Neither a link to a file nor to a folder, and none is listed."""
    (folder / "link.yaml").symlink_to(folder.parent / "secret.yaml")
    (folder / "out").symlink_to(folder.parent)
    for name in ("link.yaml", "out/secret.yaml"):
        answer = server.ask("read", {"name": name})
        assert (answer.status, "Secret" in answer.text) == (422, False)
    assert "out/secret.yaml" not in server.told("folder")["specs"]


def test_a_spec_reads_no_file_outside_either(server: Server) -> None:
    """A spec that was typed on the page includes files of the folder only."""
    given = {"name": "press.yaml", "text": f"include: [../secret.yaml]\n{SPEC}"}
    found = server.told("check", given)["findings"]
    assert any(one["severity"] == "error" and "../secret.yaml" in one["message"] for one in found)


@pytest.mark.parametrize(
    "body", [b"", b"[]", b"{", b'{"name": 1}', b'{"name": "a.yaml", "b": 1}', json.dumps({"name": "x" * 500}).encode()]
)
def test_what_is_no_question_is_refused(server: Server, body: bytes) -> None:
    """Unknown keys, wrong types, what is too long."""
    answer = server.request("POST", f"/{TOKEN}/ask/read", [body])
    assert answer.status == 400
    assert answer.json()["problems"][0]["message"]


def test_files_that_are_dropped_stay_where_they_are_put(server: Server) -> None:
    """Their names lead nowhere else."""
    for name in ("../x.scl", "/tmp/x.scl", "a/../../x.scl", "C:\\x.scl", "con.scl"):
        assert server.ask("layout", {"files": {name: ""}}).status == 422, name

"""What the tools of the page do with files and texts that are dropped onto it; they lie in a folder that soon goes."""

from __future__ import annotations

import base64
import binascii
import io
import re
import tempfile
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import Any, Literal

from plcgen import api
from plcgen.base.diagnostics import Diagnostic
from plcgen.base.display.page import page_text
from plcgen.base.display.view import PLAIN
from plcgen.base.files.options import usage
from plcgen.base.paths import trap_in
from plcgen.base.telegrams.decoded import telegram_data
from plcgen.base.telegrams.hexbytes import HexError, parse_hex
from plcgen.ds47.texts import status_answer
from plcgen.proof.audited import audit_files
from plcgen.report.registry import shipped_format
from plcgen.report.review.page import comparison_view
from plcgen.workbench.serve.proving import Typed
from plcgen.workbench.serve.spec import problem_data

MAX_DROPPED = 200
MAX_LOOKED, MAX_TELEGRAM, MAX_LINES = 64 * 1024, 512, 100
Dropped = Mapping[str, str]
"""Names of files with their bytes in Base64."""
_EXPLAINED = re.compile(
    r"(?:(?:DW)?(?:16)?#)?(?:[0-9A-F]{2}[\s_,.:-]*)+(?:>\s*(?:[0-9A-F]{2}[\s_,.:-]*)+)?|[FANCrpP]\d{2,5}|PG\d{3}|0x[0-9A-F]+",
    re.IGNORECASE,
)
_STATUS = re.compile(r"(?:DW#)?16#[0-9A-F_]{8,9}|[CD][EFB][0-9A-F]{6}", re.IGNORECASE)


@contextmanager
def laid(*groups: Dropped) -> Iterator[list[Path]]:
    """A folder for each group of files, and of the machine for no longer than this. Raises DiagnosticError."""
    with tempfile.TemporaryDirectory(prefix="plcgen-dropped-") as name:
        folders = []
        for number, files in enumerate(groups):
            folder = Path(name) / f"{number}"
            folder.mkdir()
            folders.append(folder)
            for title, content in files.items():
                pure = PurePosixPath(title)
                if trap_in(title) or pure.is_absolute() or ".." in pure.parts or len(pure.parts) > 8:
                    raise usage(title, "such a name is not taken", "give the file another name")
                target = folder.joinpath(*pure.parts)
                target.parent.mkdir(parents=True, exist_ok=True)
                try:
                    target.write_bytes(base64.b64decode(content, validate=True))
                except (binascii.Error, ValueError, OSError) as problem:
                    raise usage(title, f"it cannot be read: {problem}") from None
        yield folders


def _problems(found: tuple[Diagnostic, ...], folder: Path) -> list[dict[str, Any]]:
    return [problem_data(one, lambda file: file.removeprefix(f"{folder.as_posix()}/")) for one in found]


def look(files: Dropped) -> dict[str, Any]:
    """What is in each file: lines that ``explain`` takes, or blocks; the lines of all of them."""
    kinds, lines = {}, []
    with laid(files) as (folder,):
        for path in _each(folder):
            found = _lines(path.read_bytes()[:MAX_LOOKED])
            kinds[path.relative_to(folder).as_posix()] = "lines" if found else "blocks"
            lines += found
    return {"files": kinds, "lines": lines[:MAX_LINES]}


def _lines(data: bytes) -> list[str]:
    """The lines of a text with nothing but telegrams, STATUS values and codes, or the bytes of one telegram."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = ""
    if not text.isprintable() and set(text) & {chr(code) for code in (*range(9), *range(14, 32))}:
        text = ""
    if not text and 4 <= len(data) <= MAX_TELEGRAM:
        return [] if data[:2] in {b"\xff\xfe", b"\xfe\xff", b"PK"} else [data.hex(" ").upper()]
    found = [line.strip() for line in text.splitlines() if line.strip()]
    return found if found and all(_EXPLAINED.fullmatch(line) for line in found) else []


def audit(typed: Typed, files: Dropped) -> dict[str, Any]:
    """Hand-written blocks and calls against the spec as it is typed."""
    with laid(files) as (folder,):
        found = audit_files(_each(folder), typed.path, typed.read)
        text = shipped_format("text").render("verification", found, PLAIN).replace(f"{folder.as_posix()}/", "")
        return {"text": text, "ok": found.ok, "problems": _problems(tuple(found.outside), folder)}


def layout(files: Dropped) -> dict[str, Any]:
    """Every block of the files as a page, byte by byte."""
    with laid(files) as (folder,):
        found = api.layout(*_each(folder))
        page = shipped_format("html").render("layout", found, PLAIN) if found.blocks else ""
        return {"page": page.replace(f"{folder.as_posix()}/", ""), "problems": _problems(found.diagnostics, folder)}


def diff(old: Dropped, new: Dropped) -> dict[str, Any]:
    """Two versions of sources, as HMIs, PLCs and drives see them."""
    with laid(old, new) as (before, after):
        found = api.diff(_each(before), _each(after))
        return {"changes": comparison_view("", found, planned=True), "problems": _problems(found.diagnostics, after)}


def convert(files: Dropped, to: Literal["scl", "xml"], version: str, *, classic: bool) -> dict[str, Any]:
    """The blocks of the files in the other form, as an archive and as texts."""
    with laid(files, {}) as (folder, out):
        found = api.convert(*_each(folder), to=to, out=out, version=version, classic=classic)
        texts = {name: (out / name).read_bytes() for name in found.written}
        archive = io.BytesIO()
        with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as pack:
            for name, data in texts.items():
                pack.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), data)
        return {
            "files": [{"path": name, "text": data.decode("utf-8-sig", "replace")} for name, data in texts.items()],
            "archive": base64.b64encode(archive.getvalue()).decode() if texts else "",
            "problems": _problems(found.diagnostics, folder),
        }


def explain(text: str) -> dict[str, Any]:
    """Whatever a line is: a STATUS, a telegram, a code, a number, a message or a parameter."""
    line = text.strip()
    plain = re.sub(r"[\s_]", "", line)
    if _STATUS.fullmatch(plain):
        value = int(plain.upper().removeprefix("DW#").removeprefix("16#"), 16)
        return {"kind": "STATUS", "text": status_answer(api.decode_status(value)).text(PLAIN)}
    page = api.explain(line)
    if page is not None:
        return {"kind": "page", "text": page_text(page, PLAIN)}
    asked, _, answer = line.partition(">")
    try:
        request, data = (parse_hex(asked).data, parse_hex(answer).data) if answer else (b"", parse_hex(line).data)
    except HexError as problem:
        help_ = "a telegram in hexadecimal digits, request > answer, a STATUS, or a code such as PG209, F30001, r945"
        raise usage(line[:60], f"it is nothing that is known: {problem.reason}", help_) from None
    if not data:
        raise usage("text", "there is nothing to explain", "paste a telegram, a STATUS or a code")
    found = [telegram_data(api.decode(request))] if request else []
    return {"kind": "telegram", "telegrams": [*found, telegram_data(api.decode(data, request=request or None))]}


def _each(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.is_file())[:MAX_DROPPED]

"""Damage to delivered files: put into a copy of an example, its manifest made anew; what is found without running."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from plcgen.project.opening import open_spec
from plcgen.proof.checks import Check, Outcome
from plcgen.proof.files import delivered
from plcgen.proof.folder import read_folder
from plcgen.proof.layouts import check_layout
from tests.projects import ROOT, per_block_spec

Edit = tuple[str, str, str]
"""File, what stands there, what stands there instead; a block of the one source as if it were a file."""
FOLDERS = {"udt": "TYPE", "db": "DATA_BLOCK", "scl": "FUNCTION_BLOCK"}


def place(folder: Path, name: str) -> tuple[str, str]:
    """The file in which something lies, and which block of it is meant, if it has several."""
    room, _, file = name.partition("/")
    if (folder / name).is_file() or room not in FOLDERS:
        return name, ""
    if name == "scl/Main.scl":
        return "example/Main.scl", ""
    (source,) = folder.glob("*.scl")
    return source.name, rf'^{FOLDERS[room]} "{Path(file).stem}".*?^END_{FOLDERS[room]}'


def edited(text: str, block: str, old: str, new: str) -> str:
    """A text whose first occurrence, or that in a block, is replaced."""
    found = re.search(block, text, re.DOTALL | re.MULTILINE) if block else None
    start, end = found.span() if found else (0, len(text))
    assert old in text[start:end], f"{block}: {old}"
    return text[:start] + text[start:end].replace(old, new, 1) + text[end:]


def signed(folder: Path, files: Sequence[str]) -> None:
    """The manifest with hashes and lengths of files as they are now."""
    manifest = json.loads((folder / "manifest.json").read_text("utf-8"))
    for entry in manifest["files"]:
        if entry["path"] in files:
            data = (folder / entry["path"]).read_bytes()
            entry |= {"sha256": hashlib.sha256(data).hexdigest(), "bytes": len(data)}
    (folder / "manifest.json").write_text(json.dumps(manifest), "utf-8")


OWN_HASH = re.compile(r"^FUNCTION_BLOCK .*?^NAME : (H[0-9A-F]{7})$.*?^END_FUNCTION_BLOCK\n", re.DOTALL | re.MULTILINE)


def hash_of(block: str) -> str:
    """What a function block carries as NAME: of its lines but NAME and VERSION."""
    lines = [line for line in block.split("\n") if not re.match(r"(NAME|VERSION) :", line)]
    return "H" + hashlib.sha256("\n".join(lines).encode()).hexdigest()[:7].upper()


def hidden(folder: Path, texts: dict[str, str]) -> dict[str, str]:
    """Texts of files by name, with hashes of blocks made anew in them and in the documents beside them."""
    anew = {}
    for text in texts.values():
        anew |= {found[1]: hash_of(found[0]) for found in OWN_HASH.finditer(text)}
    changed = [(old, new) for old, new in anew.items() if old != new]
    if changed:
        texts = {**{f"xml/{p.name}": p.read_text("utf-8") for p in folder.glob("xml/*.xml")}, **texts}
    for old, new in changed:
        for before, after in ((f"NAME : {old}\n", f"NAME : {new}\n"), (f"<HeaderName>{old}<", f"<HeaderName>{new}<")):
            texts = {name: text.replace(before, after) for name, text in texts.items()}
    return texts


@contextmanager
def damaged(folder: Path, edits: Sequence[Edit], encoding: str) -> Iterator[None]:
    """The folder with the first occurrence of each text changed, and hashes that hide it; afterwards as it was."""
    places = [(*place(folder, name), old, new) for name, old, new in edits]
    texts: dict[str, str] = {}
    for name, block, old, new in places:
        own = encoding if name.endswith((".scl", ".sdf", ".inp")) else "utf-8"
        before = texts.get(name) or (folder / name).read_bytes().decode(own).replace("\r\n", "\n")
        texts[name] = edited(before, block, old, new)
    if not any("NAME : H" in old for _, _, old, _ in places):
        texts = hidden(folder, texts)
    kept = {name: (folder / name).read_bytes() for name in {"manifest.json", *texts}}
    try:
        for name, text in texts.items():
            own = encoding if name.endswith((".scl", ".sdf", ".inp")) else "utf-8"
            (folder / name).write_bytes((text.replace("\n", "\r\n") if b"\r\n" in kept[name] else text).encode(own))
        signed(folder, [name for name in texts if name != "manifest.json"])
        yield
    finally:
        for name, data in kept.items():
            (folder / name).write_bytes(data)


def spec_of(example: str) -> Path:
    """The spec of an example; "per block" behind its name: a file for each block."""
    name, _, blocks = example.partition(" ")
    return per_block_spec(name) if blocks else ROOT / "specs" / f"{name}.yaml"


def findings(example: str, folder: Path) -> list[Check]:
    """Errors of everything that reads the files without running them."""
    project = open_spec(spec_of(example)).sound()
    files = read_folder(folder, project.target)
    proofs = [plan.protocol.proof(plan) for plan in project.plans]
    checks = [*delivered(project, files)]
    checks += [check_layout(project, files, laid) for proof in proofs for laid in proof.layouts()]
    checks += [check for proof in proofs for check in proof.telegrams(files)]
    return [check for check in checks if check.outcome is Outcome.ERROR]

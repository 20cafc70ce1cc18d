"""A lock file back to a state. The file may come from anybody: bounded, every wrong value a diagnostic at its place."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from plcgen.diagnostics import Diagnostic, Report, Span
from plcgen.input.text import read_text
from plcgen.input.yaml import Node, load_yaml
from plcgen.review.compare.lockfile import ACCESS, FORMAT, content_hash
from plcgen.review.compare.model import BlockState, DriveState, JobState, MemberState, Snapshot, TelegramState

_VALUE = re.compile(
    r"(?:(?P<byte>[0-9]{1,8})\.(?P<bit>[0-7]) (?P<size>[0-9]{1,9}) (?P<unit>B|bit) )?"
    r'(?P<type>(?:"[^"\n]*"|[^"\n])+?)(?: := (?P<start>.*?))?(?: \{(?P<braces>[^{}]*)\})?\Z'
)
_SECTIONS = {"members": "Static", "input": "Input", "output": "Output", "inout": "InOut", "static": "Static"}
_SECTIONS |= {"return": "Return"}
_KINDS = ("DB", "FB", "FC", "OB", "UDT")
_HEX = re.compile(r"[0-9A-Fa-f]{2}(?: [0-9A-Fa-f]{2}){0,254}\Z")
_OPTIMIZED = {text: value for value, text in ACCESS.items()}
_LARGEST = 1 << 31
_LONGEST = 2000


@dataclass(frozen=True, slots=True)
class Lock:
    """A lock file: its state, and the sources it names, relative to its folder."""

    path: Path
    snapshot: Snapshot
    sources: tuple[str, ...]


def read_lock(path: Path) -> Lock:
    """Read a lock file.

    Raises:
        DiagnosticError: PG110, PG102, PG101.. if it is no readable YAML, PG633 for every value that is no part
            of a lock, PG634 for a block whose hash is not that of its lines.
    """
    file = path.as_posix()
    root = load_yaml(read_text(path), file)
    reader = _Reader(file)
    snapshot, sources = reader.root(root)
    reader.report.raise_on_errors()
    return Lock(path, snapshot, sources)


@dataclass(slots=True)
class _Reader:
    file: str
    report: Report = field(default_factory=Report)

    def wrong(self, message: str, node: Node | Span) -> None:
        place = node if isinstance(node, Span) else node.span
        self.report.add(Diagnostic("PG633", message, place, help="write the lock again: plcgen lock"))

    def root(self, root: Node) -> tuple[Snapshot, tuple[str, ...]]:
        snapshot = Snapshot(self.file, complete=False)
        form = root.get("format") if root.kind == "map" else None
        if form is None or form.value != FORMAT:
            shown = "none" if form is None else form.raw
            self.wrong(f"this is no layout lock of format {FORMAT} (format: {shown})", form or root)
            return snapshot, ()
        given = root.get("sources")
        sources = tuple(item.raw for item in given.items) if given is not None and given.kind == "seq" else ()
        jobs = root.get("jobs")
        if jobs is not None:
            snapshot.jobs = {key: self.job(key, node) for key, node in self.entries(jobs, "jobs")}
            drives = root.get("drives")
            for key, node in self.entries(drives, "drives") if drives is not None else ():
                snapshot.drives[key] = self.drive(key, node)
        blocks = root.get("blocks")
        if blocks is None:
            self.wrong("the lock has no blocks", root)
        else:
            snapshot.blocks = [
                block for key, node in self.entries(blocks, "blocks") if (block := self.block(key, node))
            ]
        return snapshot, sources

    def entries(self, node: Node, what: str) -> Iterator[tuple[str, Node]]:
        """Key and value of a mapping of mappings or texts."""
        if node.kind != "map":
            self.wrong(f"{what} is a mapping", node)
            return
        for key, (_, value) in node.pairs.items():
            yield key, value

    def number(self, node: Node, key: str, largest: int = _LARGEST) -> int | None:
        found = node.get(key)
        if found is None:
            return None
        if isinstance(found.value, bool) or not isinstance(found.value, int) or not 0 <= found.value <= largest:
            self.wrong(f"{key} is a number from 0 to {largest}", found)
            return None
        return found.value

    def text(self, node: Node, key: str) -> str:
        found = node.get(key)
        if found is not None and found.kind != "scalar":
            self.wrong(f"{key} is a text", found)
            return ""
        return "" if found is None else found.raw

    def block(self, key: str, node: Node) -> BlockState | None:
        kind, _, name = key.partition(" ")
        if kind not in _KINDS or not name or node.kind != "map":
            self.wrong(f'"{key[:60]}" is no block: kind ({", ".join(_KINDS)}) and name', node)
            return None
        access = self.text(node, "access")
        if access not in _OPTIMIZED:
            self.wrong(f'access is one of {", ".join(_OPTIMIZED)}, not "{access[:40]}"', node.get("access") or node)
        attributes = node.get("attributes")
        values = node.get("start_values")
        members = [
            member
            for section in _SECTIONS
            if (entries := node.get(section)) is not None
            for member in self.members(entries, section, kind)
        ]
        block = BlockState(
            kind, name, self.number(node, "number", 65535), self.number(node, "bytes"), _OPTIMIZED.get(access),
            self.text(node, "of"), "", self.text(node, "retain") == "false",
            attributes=() if attributes is None else self.pairs(attributes, "attributes"),
            members=tuple(members), assignments=() if values is None else self.pairs(values, "start_values"),
            code_hash=self.text(node, "code").removeprefix("sha256:"), span=node.span,
        )  # fmt: skip
        stored = self.text(node, "hash")
        if not self.report.has_errors and stored != content_hash(block):
            message = f"{key}: the lines do not belong to the hash {stored[:40] or '(none)'}"
            help_ = "the lock was edited or merged by hand: write it again with plcgen lock"
            self.report.add(Diagnostic("PG634", message, (node.get("hash") or node).span, help=help_))
        return block

    def pairs(self, node: Node, what: str) -> tuple[tuple[str, str], ...]:
        return tuple((key, value.raw) for key, value in self.entries(node, what))

    def members(self, node: Node, section: str, kind: str) -> list[MemberState]:
        """Members of one section; nested ones follow their parent and begin with its path."""
        flat = [m for key, value in self.entries(node, section) if (m := self.member(key, value, section, kind))]
        roots: list[_Tree] = []
        stack: list[_Tree] = []
        for member in flat:
            while stack and not member.path.startswith((f"{stack[-1].member.path}.", f"{stack[-1].member.path}[]")):
                stack.pop()
            tree = _Tree(member)
            (stack[-1].inner if stack else roots).append(tree)
            if len(stack) >= 64:
                self.wrong(f"{member.path[:60]}: nested too deeply", node)
                return []
            stack.append(tree)
        return [
            tree.state("" if section == "members" and kind in {"FC", "OB"} else _SECTIONS[section]) for tree in roots
        ]

    def member(self, key: str, node: Node, section: str, kind: str) -> MemberState | None:
        match = _VALUE.match(node.raw) if node.kind == "scalar" and len(node.raw) <= _LONGEST else None
        if match is None:
            self.wrong(f"{kind} {section}.{key[:60]} is no member: offset, size, type, start value", node)
            return None
        offset = bits = None
        if match["byte"] is not None:
            offset = 8 * int(match["byte"]) + int(match["bit"])
            bits = int(match["size"]) * (8 if match["unit"] == "B" else 1)
        braces = tuple(
            (name, value)
            for name, _, value in (part.partition("=") for part in (match["braces"] or "").split(", "))
            if name
        )
        name = key.rpartition(".")[2]
        return MemberState(name, key, match["type"], "", offset, bits, match["start"] or "", "", braces, span=node.span)

    def drive(self, key: str, node: Node) -> DriveState:
        address = self.number(node, "address", 0xFFFF_FFFF) or 0
        settings = tuple(pair for pair in self.pairs(node, "drives") if pair[0] not in {"what", "address"})
        return DriveState(key, self.text(node, "what") or "drive", address, settings, node.span)

    def job(self, key: str, node: Node) -> JobState:
        timing, trigger, telegrams = node.get("timing"), node.get("trigger"), node.get("telegrams")
        found = [] if telegrams is None else [t for item in telegrams.items if (t := self.telegram(key, item))]
        return JobState(
            key, self.text(node, "drive"), tuple(found),
            () if timing is None else self.pairs(timing, "timing"),
            () if trigger is None else self.pairs(trigger, "trigger"), node.span,
        )  # fmt: skip

    def telegram(self, key: str, node: Node) -> TelegramState | None:
        request = self.text(node, "request")
        if not _HEX.match(request):
            self.wrong(f"{key}: request is 1 to 255 bytes in hexadecimal", node.get("request") or node)
            return None
        lengths = [self.number(node, name) or 0 for name in ("positive", "negative", "buffer")]
        protocol = self.text(node, "protocol") or "ds47"
        if protocol not in {"ds47", "ppi"}:
            self.wrong(f'protocol is ds47 or ppi, not "{protocol[:40]}"', node.get("protocol") or node)
        return TelegramState(bytes.fromhex(request), lengths[0], lengths[1], lengths[2], protocol)


@dataclass(slots=True)
class _Tree:
    """A member while its nested ones are still being collected."""

    member: MemberState
    inner: list[_Tree] = field(default_factory=list)

    def state(self, section: str) -> MemberState:
        """The frozen member with everything below it; only the first level has a section."""
        m = self.member
        inner = tuple(tree.state("") for tree in self.inner)
        return MemberState(
            m.name, m.path, m.type, section, m.offset, m.bits, m.start, "", m.attributes, inner, span=m.span
        )

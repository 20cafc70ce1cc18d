"""Generated lines, diagnostics, and the cache of values that are known to be in a Python local already."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING

from plcgen.cpu.compile_model import Place, Probe, ProgramBlock, Val
from plcgen.cpu.memory import CODECS
from plcgen.cpu.semantics_scope import Scope, scalar_name
from plcgen.diagnostics import Diagnostic, Severity, Span
from plcgen.s7.types import StringType
from plcgen.scl import ast

if TYPE_CHECKING:
    from plcgen.cpu.linkage import Linkage

MAX_DIAGNOSTICS = 100
EVERYTHING = 1 << 40
Key = tuple[str, int, str]
_LOCAL = re.compile(r"\bc[0-9]+\b")


class Emitter:
    """One block on its way to Python: ``dynamic`` adds a base offset ``o`` to every access to the instance."""

    def __init__(self, owner: ProgramBlock, scope: Scope, link: Linkage, *, dynamic: bool = False) -> None:
        self.owner = owner
        self.scope = scope
        self.link = link
        self.classic = link.classic
        self.dynamic = dynamic
        self.lines: list[str] = []
        self.map: list[int] = []
        self.indent = " "
        self.line = 0
        self.cache: dict[Key, str] = {}
        self.names: dict[Key, str] = {}
        self.overlap: set[str] = set()
        self.folds: list[tuple[int, str]] = []
        self.conditional = 0
        self.temporaries = 0
        self.diagnostics: list[Diagnostic] = []
        self.calls: dict[str, Span] = {}
        self.moving = False

    # --- output ---------------------------------------------------------------------------------------

    def emit(self, code: str) -> None:
        """Add one line."""
        self.lines.append(self.indent + code)
        self.map.append(self.line)

    def insert(self, at: int, code: str, line: int) -> None:
        """Put a line before one that is there already."""
        self.lines.insert(at, code)
        self.map.insert(at, line)
        self.folds = [(place + (place >= at), name) for place, name in self.folds]

    def temporary(self) -> str:
        """Return a new Python local."""
        self.temporaries += 1
        return f"q{self.temporaries}"

    def span(self, node: ast.Node) -> Span:
        """Where a node stands."""
        return self.owner.result.span(node)

    def error(
        self, code: str, message: str, node: ast.Node, text: str = "", severity: Severity = Severity.ERROR
    ) -> None:
        """Report a problem at a node."""
        if len(self.diagnostics) < MAX_DIAGNOSTICS:
            self.diagnostics.append(Diagnostic(code, message, self.span(node), severity, help=text))

    def text(self, node: ast.Node) -> str:
        """Source text of a node on one line."""
        return " ".join(self.owner.result.tokens.source[node.start : node.end].split())

    def probe(self, node: ast.Node, kind: str) -> None:
        """Count this place, if coverage is wanted."""
        if self.link.coverage:
            span = self.span(node)
            self.link.probes.append(Probe(span.file, span.line, span.column, kind))
            self.emit(f"H[{len(self.link.probes) - 1}]+=1")

    def tidy(self) -> None:
        """Take out locals that nobody reads again."""
        source = "\n".join(self.lines)
        uses = Counter(_LOCAL.findall(source))
        lines = self.lines
        dropped: set[int] = set()
        for at, name in self.folds:
            if uses[name] == 2 and name in lines[at + 1]:
                code = lines[at].partition("=")[2]
                before, _, behind = lines[at + 1].partition(name)
                if not behind[:1].isdigit():
                    lines[at + 1] = before + code + behind
                    dropped.add(at)
            elif uses[name] == 1:
                dropped.add(at)
        self.lines = [line for at, line in enumerate(lines) if at not in dropped]
        self.map = [line for at, line in enumerate(self.map) if at not in dropped]

    # --- cache ----------------------------------------------------------------------------------------

    def forget(self) -> None:
        """Anything may have changed."""
        self.cache.clear()

    def touched(self, region: str | None, start: int, bits: int) -> None:
        """Forget values that overlap a range of bits; ``region`` None may be anywhere."""
        if region is None:
            self.cache.clear()
            return
        instances = self.link.instance_regions
        other = instances if region == "m" else {"m"} if region in instances else ()
        for key in list(self.cache):
            if key[0] == region:
                size = 1 if key[2] == "BOOL" else CODECS[key[2]].size * 8
                if key[1] < start + bits and start < key[1] + size:
                    del self.cache[key]
            elif key[0] in other:
                del self.cache[key]

    def merge(self, exits: list[dict[Key, str]]) -> None:
        """Continue behind branches: what every one of them knows is known."""
        if not exits:
            self.cache = {}
            return
        first, *rest = exits
        self.cache = {key: name for key, name in first.items() if all(key in other for other in rest)}

    # --- memory ---------------------------------------------------------------------------------------

    def address(self, place: Place) -> str:
        """Generated byte offset of a place."""
        parts = []
        if place.mem == "m" and self.dynamic:
            parts.append("o")
        if place.dyn:
            parts.append(place.dyn)
        if place.off >= 8 or not parts:
            parts.append(str(place.off // 8))
        return "+".join(parts)

    def load(self, place: Place) -> Val:
        """Value of a scalar place; a structure stays a place."""
        type_ = scalar_name(place.shape)
        if place.local:
            return Val(place.local, type_, place=place)
        if not type_ or type_ == "VARIANT":
            return Val("", "", place=place)
        if isinstance(place.shape.type, StringType):
            read = "r_s" if type_ == "STRING" else "r_ws"
            return Val(f"{read}({place.mem},{self.address(place)})", type_, place=place)
        key = self.key(place, type_)
        known = self.cache.get(key) if key else None
        if known is not None:
            return Val(known, type_, place=place)
        code = self.read_code(place, type_)
        if key and not self.conditional:
            name = self.names.setdefault(key, f"c{len(self.names)}")
            self.cache[key] = name
            code = f"({name}:={code})"
        return Val(code, type_, place=place)

    def key(self, place: Place, type_: str) -> Key | None:
        """Cache key of a place, None if its value must be read every time."""
        if place.region is None or not place.fixed or (type_ != "BOOL" and type_ not in CODECS):
            return None
        if place.overlay:
            self.overlap.add(place.region)
        return place.region, place.off, type_

    def read_code(self, place: Place, type_: str) -> str:
        """Generated expression that reads a scalar."""
        if type_ == "BOOL":
            if place.dynbit:
                name = self.temporary()
                bit = self.bit(place)
                base = self.address(Place(place.shape, place.mem, 0, place.dyn))
                return f"({place.mem}[{base}+(({name}:={bit})>>3)]>>({name}&7)&1)"
            return f"({place.mem}[{self.address(place)}]&{1 << place.off % 8})"
        return CODECS[type_].read.format(m=place.mem, o=self.address(place))

    @staticmethod
    def bit(place: Place) -> str:
        """Bit number behind the base of a place with a computed bit."""
        return f"{place.off}+{place.dynbit}" if place.off else place.dynbit

    def store(self, place: Place, code: str, const: object = None) -> None:
        """Write a value that has the type of the place already."""
        type_ = scalar_name(place.shape)
        if place.local:
            self.emit(f"{place.local}={code}")
            return
        if isinstance(place.shape.type, StringType):
            write = "w_s" if type_ == "STRING" else "w_ws"
            self.emit(f"{write}({place.mem},{self.address(place)},{place.shape.type.length},{code})")
            self.touched(place.region, 0, EVERYTHING)
            return
        key = self.key(place, type_)
        if key is None:
            self.touched(place.region, 0, EVERYTHING)
        elif key[0] in self.overlap or (self.aliased and (key[0] == "m" or key[0] in self.link.instance_regions)):
            self.touched(place.region, place.off, place.shape.bits)
        if key is not None:
            name = self.names.setdefault(key, f"c{len(self.names)}")
            self.cache[key] = name
            self.folds.append((len(self.lines), name))
            self.emit(f"{name}={code}")
            code = name
        self.emit(self.write_code(place, type_, code, const))

    aliased = False
    """Whether the block has used an instance DB by its name, so that two names may mean the same bytes."""

    def write_code(self, place: Place, type_: str, code: str, const: object) -> str:
        """Generated statement that writes a scalar."""
        if type_ != "BOOL":
            return CODECS[type_].write.format(m=place.mem, o=self.address(place), v=code)
        if place.dynbit:
            base = self.address(Place(place.shape, place.mem, 0, place.dyn))
            return f"w_bit({place.mem},{base},{self.bit(place)},{code})"
        cell = f"{place.mem}[{self.address(place)}]"
        mask = 1 << place.off % 8
        if const is True:
            return f"{cell}|={mask}"
        if const is False:
            return f"{cell}&={255 - mask}"
        return f"{cell}={cell}|{mask} if {code} else {cell}&{255 - mask}"

"""Calls of the functions in the table of ``system.library``, and of those that move memory: BLKMOV, FILL, PEEK."""

from __future__ import annotations

import re
from dataclasses import dataclass

from plcgen.s7.cpu.compiler.access import Access
from plcgen.s7.cpu.compiler.arguments import References
from plcgen.s7.cpu.compiler.assignments import Assignments
from plcgen.s7.cpu.compiler.context import Context, Listing
from plcgen.s7.cpu.compiler.conversions import coerce, truth
from plcgen.s7.cpu.compiler.functions import Functions, bit_type
from plcgen.s7.cpu.compiler.places import Places
from plcgen.s7.cpu.compiler.scope import UNKNOWN, Expressions, MemoryPlace, Val, scalar_name, unknown
from plcgen.s7.cpu.memory import CODECS
from plcgen.s7.cpu.system.library import GROUPS, ROWS, Row, parts
from plcgen.s7.cpu.type_rules import BITS, INT_CONST, INTEGERS, REAL_CONST, TEXT_CONST, canonical, common_type
from plcgen.s7.scl import ast
from plcgen.s7.scl.instructions import parameters
from plcgen.s7.types.data_types import ArrayType

_CONSTANTS = {
    "num": {INT_CONST: "DINT", REAL_CONST: "REAL"}, "int": {INT_CONST: "DINT"}, "real": {REAL_CONST: "REAL"},
    "text": {TEXT_CONST: "STRING", "CHAR": "STRING", "WCHAR": "WSTRING"},
}  # fmt: skip
"""Types of constants without one in each group."""
_PLACES = frozenset({"ref", "bit", "tail"})
_SPECIAL = _PLACES | {"timer", "counter", "s5"}
"""Inputs that are no values of a type: references to variables, bits in memory, numbers of cells, S5 times."""
_OUTPUT = re.compile("OUT[0-9]+")
_CELL = re.compile(r"%?[TCZ]([0-9]{1,5})", re.IGNORECASE)


def row_of(name: str) -> tuple[str, Row, str] | None:
    """Name and row of a function of the table by its upper-case name, and the type that stands behind it."""
    if name in ROWS:
        return name, ROWS[name], ""
    for base, row in ROWS.items():
        type_ = canonical(name[len(base) + 1 :]) if name.startswith(f"{base}_") else ""
        if type_ in row.named:
            return base, row, type_
    return None


@dataclass(slots=True, eq=False)
class Library:
    """Functions of the table: inputs are converted, outputs assigned behind the call."""

    context: Context
    out: Listing
    access: Access
    expressions: Expressions
    references: References
    assignments: Assignments
    functions: Functions

    def compile(self, node: ast.Call, name: str) -> Val | None:
        """Compile a call, None if the target has no function of that name in the table."""
        if name.partition("_")[0] == "DEMUX" and not self.context.classic:
            return self.demultiplex(node, canonical(name[6:]))
        found = row_of(name)
        if found is None or self.context.link.dialect not in found[1].targets:
            return None
        base, row, suffix = found
        outputs = parts(row.outputs)
        every = list(dict.fromkeys(part.name for part in (*parts(row.inputs), *outputs)))
        optional = {part.name for part in (*parts(row.inputs), *outputs) if part.default}
        bound = self.functions.bind(node, (*every, "RET_VAL"), needed=[name for name in every if name not in optional])
        taken = self.inputs(row, bound)
        places = [self.assignments.target(bound[part.name]) if part.name in bound else None for part in outputs]
        if taken is None or any(part.name in bound and not place for part, place in zip(outputs, places, strict=True)):
            return unknown()
        codes, types = taken
        targets: list[tuple[MemoryPlace | None, str, ast.Expression]] = []
        for place, part in zip(places, outputs, strict=True):
            if place is None:
                targets.append((None, part.type, node))
                continue
            own = scalar_name(place.shape)
            if part.type in GROUPS and own not in GROUPS[part.type]:
                return self.functions.refuse(node, name, Val("", own))
            types = (*types, own if part.type in GROUPS else part.type)
            targets.append((place, types[-1], bound[part.name]))
            if part.before:
                codes.append(self.access.load(place).wrapped)
        result = suffix or (row.result if isinstance(row.result, str) else row.result(types))
        if result is None:
            self.context.error("PG821", f"{name} does not take {' and '.join(types)}", node)
            return unknown()
        head = [repr(tuple(filter(None, (*types, result))))] if row.typed else []
        value = self.emit(row, f"L_{base}({','.join([*head, *codes])})", result, targets)
        returned = self.assignments.target(bound["RET_VAL"]) if "RET_VAL" in bound else None
        if returned is not None:
            self.assignments.assign_value(returned, value, bound["RET_VAL"])
        return value

    def emit(
        self, row: Row, call: str, result: str, targets: list[tuple[MemoryPlace | None, str, ast.Expression]]
    ) -> Val:
        """Emit the call where more than a value comes out of it."""
        acts = any(part.type in _PLACES for part in parts(row.inputs)) or bool(row.of)
        if not row.checked and not targets and not acts:
            return Val(f"f32({call})" if result == "REAL" else call, result, raw=result in INTEGERS)
        self.context.settle()
        name = self.out.temporary()
        self.out.emit(f"{name}={call}")
        if row.checked and self.context.link.eno:
            self.out.emit(f"E[0]={name}[0]")
        if acts:
            self.access.forget()
        if not row.checked and not targets:
            return Val(name, result, raw=result in INTEGERS)
        first = 1 if row.checked else 0
        for position, (place, type_, node) in enumerate(targets, first + 1):
            code = f"{name}[{position}]"
            if place is None:
                continue
            self.assignments.assign_value(place, Val(f"f32({code})" if type_ == "REAL" else code, type_), node)
        code = f"{name}[{first}]"
        return Val(f"f32({code})" if result == "REAL" else code, result, raw=result in INTEGERS)

    def inputs(self, row: Row, bound: dict[str, ast.Expression]) -> tuple[list[str], tuple[str, ...]] | None:
        """Code and types of the inputs; None if one has none of the types that are taken."""
        wanted = parts(row.inputs)
        given = [(part, bound[part.name]) for part in wanted if part.name in bound and part.type not in _SPECIAL]
        values = dict(zip((part.name for part, _ in given), self.functions.values([e for _, e in given]), strict=True))
        common: str | None = None
        for part, _ in given:
            if part.type == "same":
                type_ = values[part.name][0].type
                common = type_ if common is None else common_type(common, type_, self.context.rules)
                common = common or ""
        common = {INT_CONST: "INT", REAL_CONST: "REAL"}.get(common or "", common)
        codes: list[str] = []
        types: list[str] = []
        for part in wanted:
            if part.type in _SPECIAL and part.name in bound:
                codes.append(self.special(part.type, bound[part.name]))
                types.append("")
                continue
            if part.name not in values:
                codes.append(part.default)
                types.append(part.type)
                continue
            value, expression = values[part.name]
            wide = common if part.type == "same" else part.type
            type_ = wide or ""
            if type_ in GROUPS:
                constant = type_ == "bits" and value.type == INT_CONST
                type_ = bit_type(value.const) if constant else _CONSTANTS.get(type_, {}).get(value.type, value.type)
            allowed = GROUPS.get("num" if part.type == "same" else part.type)
            if value.type == UNKNOWN:
                return None
            if allowed is not None and type_ not in allowed:
                self.functions.refuse(expression, part.name, value)
                return None
            codes.append(coerce(self.context, value, type_, expression))
            types.append(type_)
        return codes, tuple(types)

    def special(self, type_: str, node: ast.Expression) -> str:
        """Code of an input that is no value of a type."""
        if type_ == "ref":
            return self.references.typed(node)
        if type_ in {"bit", "tail"}:
            return self.references.bit(node) if type_ == "bit" else self.references.tail(node)
        if type_ != "s5":
            text = self.context.text(node)
            found = _CELL.fullmatch(text)
            known = self.context.link.cells.get(text.strip('"').upper())
            if found is not None or known is not None:
                return found[1] if found is not None else str(known)
            return self.expressions.value(node).wrapped
        value = self.expressions.value(node)
        if value.type == "TIME":
            return f"to_s5({value.wrapped})"
        return value.wrapped if value.type == "S5TIME" else coerce(self.context, value, "WORD", node)

    def demultiplex(self, node: ast.Call, type_: str) -> Val:
        """DEMUX: the value to one of the outputs; ENO FALSE if it is OUTELSE."""
        given = {(argument.name or "").upper(): argument.value for argument in node.arguments}
        outputs = sorted((int(name[3:]), value) for name, value in given.items() if _OUTPUT.fullmatch(name))
        if "K" not in given or "IN" not in given or not outputs:
            self.context.error("PG822", "DEMUX has K, IN, OUT0, OUT1 and so on, and OUTELSE", node)
            return unknown()
        places = [self.assignments.target(value) for _, value in outputs]
        (selector, _), (value, _) = self.functions.values([given["K"], given["IN"]])
        if UNKNOWN in {selector.type, value.type} or None in places:
            return unknown()
        type_ = type_ or {INT_CONST: "INT", REAL_CONST: "REAL"}.get(value.type, value.type)
        self.context.settle()
        chosen, name = self.out.temporary(), self.out.temporary()
        self.out.emit(f"{chosen}={selector.wrapped};{name}={coerce(self.context, value, type_, given['IN'])}")
        for position, ((number, target), place) in enumerate(zip(outputs, places, strict=True)):
            self.out.emit(f"{'el' if position else ''}if {chosen}=={number}:")
            self.branch(place, Val(name, type_), target)
        self.out.emit("else:")
        self.out.indent += " "
        self.out.emit("E[0]=False")
        if "OUTELSE" in given:
            place = self.assignments.target(given["OUTELSE"])
            if place is not None:
                self.assignments.assign_value(place, Val(name, type_), given["OUTELSE"])
        self.out.indent = self.out.indent[:-1]
        self.access.forget()
        return Val("", "")

    def branch(self, place: MemoryPlace | None, value: Val, node: ast.Expression) -> None:
        """One assignment behind a condition."""
        self.out.indent += " "
        if place is not None:
            self.access.forget()
            self.assignments.assign_value(place, value, node)
        self.out.indent = self.out.indent[:-1]


_MOVES = {"BLKMOV": "blkmov", "SFC20": "blkmov", "UBLKMOV": "blkmov", "SFC81": "blkmov"}
_WHOLE = frozenset({"UBLKMOV", "SFC81"})
"""Copies that no interrupt divides."""
_FILLS = {"FILL": "fill", "SFC21": "fill"}
_ELEMENTS = frozenset({"MOVE_BLK", "UMOVE_BLK", "FILL_BLK", "UFILL_BLK"})
_SERIAL = frozenset({"READ_BIG", "WRITE_BIG", "READ_LITTLE", "WRITE_LITTLE"})
_PEEKS = {"PEEK": "BYTE", "PEEK_BYTE": "BYTE", "PEEK_WORD": "WORD", "PEEK_DWORD": "DWORD", "PEEK_LWORD": "LWORD"}


def is_move(name: str) -> bool:
    """Whether a function of the language, upper case, is one of those here."""
    listed = name in _MOVES or name in _FILLS or name in _ELEMENTS or name in _SERIAL
    return listed or name[:4] in {"PEEK", "POKE"}


@dataclass(slots=True, eq=False)
class Moves:
    """Functions with memory behind them."""

    context: Context
    out: Listing
    access: Access
    expressions: Expressions
    places: Places
    references: References
    assignments: Assignments
    functions: Functions

    def compile(self, node: ast.Call, name: str) -> Val | None:
        """Compile a function of the language, None if there is none of that name."""
        if name in _MOVES or name in _FILLS:
            return self.move(node, name)
        if name in _ELEMENTS:
            return self.move_elements(node, name)
        if name in _SERIAL:
            return self.serialize(node, name)
        return self.peek_poke(node, name)

    def move(self, node: ast.Call, name: str) -> Val:
        """``BLKMOV(SRCBLK := a, DSTBLK => b)`` and FILL; RET_VAL may be a parameter too."""
        names = ("SRCBLK", "DSTBLK") if name in _MOVES else ("BVAL", "BLK")
        bound = self.functions.bind(node, names, ("RET_VAL",))
        source, target = self.references.reference(bound[names[0]]), self.references.reference(bound[names[1]])
        move = (_MOVES | _FILLS)[name]
        if move == "blkmov" and self.is_text(bound[names[0]]):
            move, source = ("blkmov_text", source) if self.is_text(bound[names[1]]) else (move, f"chars({source})")
        result = self.out.temporary()
        whole = not self.context.preemptive or name in _FILLS or name in _WHOLE
        between = "" if whole else f",lambda:{self.context.point_code('copy', node)}"
        self.context.settle()
        self.out.emit(f"{result}={move}({source},{target}{between})")
        self.access.forget()
        if "RET_VAL" in bound:
            place = self.places.place(bound["RET_VAL"])
            if place is not None:
                self.assignments.assign_value(place, Val(result, "INT"), bound["RET_VAL"])
        return Val(result, "INT")

    def is_text(self, node: ast.Expression) -> bool:
        """Whether it is a variable of type STRING."""
        place = self.places.place(node) if isinstance(node, ast.Name | ast.Member | ast.Index) else None
        return place is not None and not place.local and scalar_name(place.shape) == "STRING"

    def tail(self, node: ast.Expression) -> str | None:
        """Reference from an element to the end of its array."""
        if not isinstance(node, ast.Index):
            self.context.error("PG821", "the first element of a range is needed, for example a[0]", node)
            return None
        array, element = self.places.place(node.base), self.places.place(node)
        if array is None or element is None or not isinstance(array.shape.type, ArrayType):
            return None
        if element.dynbit or element.shape.bits < 8:
            self.context.error("PG827", "the soft CPU moves no single bits of arrays", node)
            return None
        name = self.out.temporary()
        self.out.emit(f"{name}={self.access.address(element)}")
        return f"({element.mem},{name},{self.access.address(array)}+{array.shape.bits // 8}-{name})"

    def move_elements(self, node: ast.Call, name: str) -> Val:
        """``MOVE_BLK(IN := a[0], COUNT := n, OUT => b[0])`` and FILL_BLK."""
        bound = self.functions.bind(node, parameters()[name])
        count = self.expressions.value(bound["COUNT"]).wrapped
        if name.endswith("FILL_BLK") and isinstance(bound["OUT"], ast.Member) and self.places.place(bound["OUT"]):
            self.context.error("PG827", f"the soft CPU executes {name} with elements of an array only", node)
            return unknown()  # help of the TIA Portal, FILL_BLK, "Examples with a structure"
        target = self.tail(bound["OUT"])
        if name.endswith("FILL_BLK"):
            place = self.places.place(bound["OUT"])
            if place is None or target is None:
                return unknown()
            type_ = scalar_name(place.shape)
            value = coerce(self.context, self.expressions.value(bound["IN"]), type_, bound["IN"])
            self.out.emit(f"fill_elements({target},{count},{type_!r},{value})")
        else:
            source = self.tail(bound["IN"])
            places = self.places.place(bound["IN"]), self.places.place(bound["OUT"])
            if source is None or target is None or places[0] is None or places[1] is None:
                return unknown()
            if scalar_name(places[0].shape) != scalar_name(places[1].shape):
                self.context.error("PG821", "the elements have different types", node)
            size = places[0].shape.bits // 8
            self.out.emit(f"move_elements({source},{target},{count},{size})")
        self.access.forget()
        return Val("", "")

    def peek_poke(self, node: ast.Call, name: str) -> Val | None:
        """Access by area code, DB number and offset."""
        if name == "POKE_BLK":
            return self.poke_block(node)
        bit = ("BITOFFSET",) if name.endswith("_BOOL") else ()
        value = ("VALUE",) if name.startswith("POKE") else ()
        bound = self.functions.bind(node, ("AREA", "DBNUMBER", "BYTEOFFSET", *bit, *value))
        codes = [self.number(bound[key]) for key in ("AREA", "DBNUMBER", "BYTEOFFSET", *bit)]
        place = ",".join(codes)
        if name in _PEEKS:
            return Val(self.access.after_point(f"peek({place},{BITS[_PEEKS[name]] // 8})"), _PEEKS[name])
        if name == "PEEK_BOOL":
            return Val(self.access.after_point(f"peek_bit({place})"), "BOOL")
        if name not in {"POKE", "POKE_BOOL", "POKE_BYTE", "POKE_WORD", "POKE_DWORD"}:
            return None
        written = self.expressions.value(bound["VALUE"])
        if name == "POKE_BOOL":
            flag = self.access.before_store(truth(self.context, written, bound["VALUE"]))
            self.out.emit(f"poke_bit({place},{flag})")
        else:
            type_ = "BYTE" if written.type == INT_CONST else written.type
            if type_ not in CODECS:
                return self.functions.refuse(node, name, written)
            code = self.access.before_store(coerce(self.context, written, type_, bound["VALUE"]))
            self.out.emit(f"poke({place},{CODECS[type_].size},{code})")
        self.access.forget()
        return Val("", "")

    def number(self, expression: ast.Expression) -> str:
        """Code of an integer or bit string."""
        value = self.expressions.value(expression)
        if value.type in {"BOOL", ""}:
            self.context.error("PG821", "a number is needed", expression)
        return value.wrapped

    def poke_block(self, node: ast.Call) -> Val:
        """POKE_BLK copies between areas."""
        names = parameters()["POKE_BLK"]
        bound = self.functions.bind(node, names)
        self.out.emit(f"poke_block({','.join(self.number(bound[key]) for key in names)})")
        self.access.forget()
        return Val("", "")

    def serialize(self, node: ast.Call, name: str) -> Val:
        """Value between a variable and bytes of an array; POS moves on, the result is an error number."""
        reading = name.startswith("READ")
        bound = self.functions.bind(node, parameters()[name])
        array = self.references.reference(bound["SRC_ARRAY" if reading else "DEST_ARRAY"])
        variable = bound["DEST_VARIABLE" if reading else "SRC_VARIABLE"]
        position = self.places.place(bound["POS"])
        value = self.expressions.value(variable)
        place = self.places.place(variable) if reading else value.place
        if value.type not in CODECS:
            return self.functions.refuse(node, name, value)
        if position is None or (reading and place is None) or self.context.is_opaque(position.shape):
            return unknown()
        if scalar_name(position.shape) not in {*INTEGERS, *BITS}:
            return self.functions.refuse(node, name, Val("", scalar_name(position.shape)))
        order = "big" if name.endswith("BIG") else "little"
        codec = CODECS[value.type]
        result = self.out.temporary()
        before = self.access.load(position).code
        scratch = f"{result}b"
        if reading and place is not None:
            self.out.emit(f"{result},{scratch}=take({array},{before},{codec.size},{order!r})")
            self.store_if_done(result, place, codec.read.format(m=scratch, o=0))
        else:
            self.out.emit(f"{scratch}=local({codec.size})")
            self.out.emit(codec.write.format(m=scratch, o=0, v=value.wrapped))
            self.out.emit(f"{result}=put({array},{before},{scratch},{order!r})")
        self.store_if_done(result, position, f"{self.access.load(position).code}+{codec.size}")
        self.access.forget()
        return Val(result, "WORD" if self.context.classic else "INT")

    def store_if_done(self, result: str, place: MemoryPlace, code: str) -> None:
        """Store a value if the error number in ``result`` is 0."""
        self.out.emit(f"if not {result}:")
        self.out.indent += " "
        self.access.store(place, code)
        self.out.indent = self.out.indent[:-1]

"""Functions that move memory: BLKMOV, FILL, MOVE_BLK, PEEK and POKE, READ_BIG and WRITE_BIG."""

from __future__ import annotations

from dataclasses import dataclass

from plcgen.s7.cpu.compiler.access import Access
from plcgen.s7.cpu.compiler.assignments import Assignments
from plcgen.s7.cpu.compiler.context import Context, Listing
from plcgen.s7.cpu.compiler.conversions import coerce, truth
from plcgen.s7.cpu.compiler.expressions import Expressions
from plcgen.s7.cpu.compiler.functions import Functions
from plcgen.s7.cpu.compiler.places import Places
from plcgen.s7.cpu.compiler.references import References
from plcgen.s7.cpu.compiler.scope import scalar_name
from plcgen.s7.cpu.compiler.values import MemoryPlace, Val, unknown
from plcgen.s7.cpu.memory import CODECS
from plcgen.s7.cpu.type_rules import BITS, INT_CONST, INTEGERS
from plcgen.s7.scl import ast
from plcgen.s7.scl.instructions import parameters
from plcgen.s7.types.data_types import ArrayType

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

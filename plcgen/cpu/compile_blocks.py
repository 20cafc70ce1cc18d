"""Functions that move memory: BLKMOV, FILL, MOVE_BLK, PEEK and POKE, READ_BIG and WRITE_BIG."""

from __future__ import annotations

from plcgen.cpu.compile_functions import FunctionCompiler
from plcgen.cpu.compile_model import UNKNOWN, Place, Val
from plcgen.cpu.memory import CODECS
from plcgen.cpu.semantics_scope import scalar_name
from plcgen.cpu.semantics_types import BITS, INT_CONST
from plcgen.s7.types import ArrayType
from plcgen.scl import ast

_MOVES = {"BLKMOV": "blkmov", "SFC20": "blkmov", "UBLKMOV": "blkmov", "SFC81": "blkmov"}
_FILLS = {"FILL": "fill", "SFC21": "fill"}
_PEEKS = {"PEEK": "BYTE", "PEEK_BYTE": "BYTE", "PEEK_WORD": "WORD", "PEEK_DWORD": "DWORD", "PEEK_LWORD": "LWORD"}


class MoveCompiler(FunctionCompiler):
    """The last part of expressions: functions with memory behind them."""

    def function(self, node: ast.Call, name: str) -> Val | None:
        """Compile a function of the language, None if there is none of that name."""
        if name in _MOVES or name in _FILLS:
            return self.move(node, name)
        if name in {"MOVE_BLK", "UMOVE_BLK", "FILL_BLK", "UFILL_BLK"}:
            return self.move_elements(node, name)
        if name.startswith(("PEEK", "POKE")):
            return self.peek_poke(node, name)
        if name in {"READ_BIG", "WRITE_BIG", "READ_LITTLE", "WRITE_LITTLE"}:
            return self.serialize(node, name)
        return super().function(node, name)

    def move(self, node: ast.Call, name: str) -> Val:
        """``BLKMOV(SRCBLK := a, DSTBLK => b)`` and FILL; RET_VAL may be a parameter too."""
        names = ("SRCBLK", "DSTBLK") if name in _MOVES else ("BVAL", "BLK")
        bound = self.bind(node, names, ("RET_VAL",))
        if not bound:
            return self.unknown()
        source, target = self.reference(bound[names[0]]), self.reference(bound[names[1]])
        result = self.temporary()
        self.emit(f"{result}={(_MOVES | _FILLS)[name]}({source},{target})")
        self.forget()
        if "RET_VAL" in bound:
            place = self.place(bound["RET_VAL"])
            if place is not None:
                self.assign_value(place, Val(result, "INT"), bound["RET_VAL"])
        return Val(result, "INT")

    # --- elements of arrays ---------------------------------------------------------------------------

    def tail(self, node: ast.Expression) -> str | None:
        """Reference from an element to the end of its array."""
        if not isinstance(node, ast.Index):
            self.error("PG821", "the first element of a range is needed, for example a[0]", node)
            return None
        array, element = self.place(node.base), self.place(node)
        if array is None or element is None or not isinstance(array.shape.type, ArrayType):
            return None
        if element.dynbit or element.shape.bits < 8:
            self.error("PG827", "the soft CPU moves no single bits of arrays", node)
            return None
        name = self.temporary()
        self.emit(f"{name}={self.address(element)}")
        return f"({element.mem},{name},{self.address(array)}+{array.shape.bits // 8}-{name})"

    def move_elements(self, node: ast.Call, name: str) -> Val:
        """``MOVE_BLK(IN := a[0], COUNT := n, OUT => b[0])`` and FILL_BLK."""
        bound = self.bind(node, ("IN", "COUNT", "OUT"))
        if not bound:
            return self.unknown()
        count = self.ready(self.expression(bound["COUNT"]))
        target = self.tail(bound["OUT"])
        if name.endswith("FILL_BLK"):
            place = self.place(bound["OUT"])
            if place is None or target is None:
                return self.unknown()
            type_ = scalar_name(place.shape)
            value = self.coerce(self.expression(bound["IN"]), type_, bound["IN"])
            self.emit(f"fill_elements({target},{count},{type_!r},{value})")
        else:
            source = self.tail(bound["IN"])
            places = self.place(bound["IN"]), self.place(bound["OUT"])
            if source is None or target is None or places[0] is None or places[1] is None:
                return self.unknown()
            if scalar_name(places[0].shape) != scalar_name(places[1].shape):
                self.error("PG821", "the elements have different types", node)
            size = places[0].shape.bits // 8
            self.emit(f"move_elements({source},{target},{count},{size})")
        self.forget()
        return Val("", "")

    # --- PEEK and POKE --------------------------------------------------------------------------------

    def peek_poke(self, node: ast.Call, name: str) -> Val | None:
        """Access by area code, DB number and offset."""
        if name == "POKE_BLK":
            return self.poke_block(node)
        bit = ("BITOFFSET",) if name.endswith("_BOOL") else ()
        value = ("VALUE",) if name.startswith("POKE") else ()
        bound = self.bind(node, ("AREA", "DBNUMBER", "BYTEOFFSET", *bit, *value))
        if not bound:
            return self.unknown()
        codes = [self.number(bound[key]) for key in ("AREA", "DBNUMBER", "BYTEOFFSET", *bit)]
        place = ",".join(codes)
        if name in _PEEKS:
            return Val(f"peek({place},{BITS[_PEEKS[name]] // 8})", _PEEKS[name])
        if name == "PEEK_BOOL":
            return Val(f"peek_bit({place})", "BOOL")
        if name not in {"POKE", "POKE_BOOL", "POKE_BYTE", "POKE_WORD", "POKE_DWORD"}:
            return None
        written = self.expression(bound["VALUE"])
        if name == "POKE_BOOL":
            self.emit(f"poke_bit({place},{self.truth(written, bound['VALUE'])})")
        else:
            type_ = "BYTE" if written.type == INT_CONST else written.type
            if type_ not in CODECS:
                return self.refuse(node, name, written)
            self.emit(f"poke({place},{CODECS[type_].size},{self.coerce(written, type_, bound['VALUE'])})")
        self.forget()
        return Val("", "")

    def number(self, expression: ast.Expression) -> str:
        """Code of an integer or bit string."""
        value = self.expression(expression)
        if value.type in {"BOOL", ""}:
            self.error("PG821", "a number is needed", expression)
        return self.ready(value)

    def poke_block(self, node: ast.Call) -> Val:
        """POKE_BLK copies between areas."""
        names = ("AREA_SRC", "DBNUMBER_SRC", "BYTEOFFSET_SRC", "AREA_DEST", "DBNUMBER_DEST", "BYTEOFFSET_DEST", "COUNT")
        bound = self.bind(node, names)
        if bound:
            self.emit(f"poke_block({','.join(self.number(bound[key]) for key in names)})")
            self.forget()
        return Val("", "")

    # --- READ_BIG and WRITE_BIG -----------------------------------------------------------------------

    def serialize(self, node: ast.Call, name: str) -> Val:
        """Value between a variable and bytes of an array; POS moves on, the result is an error number."""
        reading = name.startswith("READ")
        names = ("SRC_ARRAY", "DEST_VARIABLE", "POS") if reading else ("SRC_VARIABLE", "DEST_ARRAY", "POS")
        bound = self.bind(node, names)
        if not bound:
            return self.unknown()
        array = self.reference(bound["SRC_ARRAY" if reading else "DEST_ARRAY"])
        variable = bound["DEST_VARIABLE" if reading else "SRC_VARIABLE"]
        position = self.place(bound["POS"])
        value = self.expression(variable)
        place = self.place(variable) if reading else value.place
        if position is None or value.type not in CODECS or (reading and place is None):
            return self.refuse(node, name, value) if value.type != UNKNOWN else value
        order = "big" if name.endswith("BIG") else "little"
        result = self.temporary()
        before = self.load(position).code
        scratch = f"{result}b"
        if reading and place is not None:
            self.emit(f"{result},{scratch}=take({array},{before},{CODECS[value.type].size},{order!r})")
            self.read_scratch(result, scratch, place, position, value.type)
        else:
            self.emit(f"{scratch}=local({CODECS[value.type].size})")
            self.emit(CODECS[value.type].write.format(m=scratch, o=0, v=self.ready(value)))
            self.emit(f"{result}=put({array},{before},{scratch},{order!r})")
            self.emit(f"if not {result}:")
            self.advance(position, CODECS[value.type].size)
        self.forget()
        return Val(result, "WORD" if self.classic else "INT")

    def read_scratch(self, result: str, scratch: str, place: Place, position: Place, type_: str) -> None:
        """Store what was read and move POS on, if it worked."""
        self.emit(f"if not {result}:")
        self.indent += " "
        self.store(place, CODECS[type_].read.format(m=scratch, o=0))
        self.indent = self.indent[:-1]
        self.emit(f"if not {result}:")
        self.advance(position, CODECS[type_].size)

    def advance(self, position: Place, size: int) -> None:
        """Add to POS inside the IF that was just emitted."""
        self.indent += " "
        self.store(position, f"{self.load(position).code}+{size}")
        self.indent = self.indent[:-1]

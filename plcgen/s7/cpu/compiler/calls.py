"""Calls: instances of function blocks, system function blocks, functions of the program."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.s7.cpu.compiler.access import Access
from plcgen.s7.cpu.compiler.arguments import Arguments, References
from plcgen.s7.cpu.compiler.assignments import Assignments
from plcgen.s7.cpu.compiler.context import Context, Listing
from plcgen.s7.cpu.compiler.conversions import coerce, truth
from plcgen.s7.cpu.compiler.functions import Functions, Reported
from plcgen.s7.cpu.compiler.library import Library, Moves, is_move
from plcgen.s7.cpu.compiler.places import Places
from plcgen.s7.cpu.compiler.scope import UNKNOWN, Expressions, MemoryPlace, Val, function_parameters, unknown
from plcgen.s7.cpu.compiler.statements import Watchdog
from plcgen.s7.cpu.linkage import ProgramBlock
from plcgen.s7.cpu.system.interfaces import SystemFb, system_fbs
from plcgen.s7.layout.shapes import bare_shape
from plcgen.s7.scl import ast
from plcgen.s7.scl.instructions import INSTRUCTIONS
from plcgen.s7.types.blocks import BlockKind, SectionKind
from plcgen.s7.types.data_types import Elementary, NamedType, StringType
from plcgen.s7.types.system import system_block

_METHODS = frozenset({"TON", "TOF", "TP"})
_TIMER_TYPES = frozenset({"IEC_TIMER", *(f"{name}_TIME" for name in _METHODS)})
"""Types of one layout that are called as ``timer.TON(..)`` on an S7-1200/1500."""
_LIKEWISE = re.compile(r"IEC_L?TIMER|(?:TP|TON|TOF|TONR)_L?TIME|IEC_U?[SDL]?COUNTER|CT(?:U|D|UD)_U?[SDL]?INT")
_FORMS = _METHODS | {"TONR", "CTU", "CTD", "CTUD"}
"""Of these, the soft CPU executes those above; all of them compile (help of the TIA Portal, timers and counters)."""
_IN, _OUT, _INOUT = SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT


@dataclass(slots=True, eq=False)
class Calls:
    """Everything with parentheses behind a name."""

    context: Context
    out: Listing
    access: Access
    expressions: Expressions
    places: Places
    references: References
    assignments: Assignments
    arguments: Arguments
    functions: Functions
    library: Library
    moves: Moves
    watchdog: Watchdog

    def instruction(self, node: ast.Call, name: str) -> Val | None:
        """Compile a function of the language, None if there is none of that name."""
        enabled = next((argument for argument in node.arguments if (argument.name or "").upper() == "ENO"), None)
        if enabled is not None:
            self.out.emit("E[0]=True")
        try:
            if is_move(name):
                value = self.moves.compile(node, name)
            else:
                value = self.library.compile(node, name) or self.functions.compile(node, name)
        except Reported:
            return unknown()
        if enabled is not None and value is not None:
            if value.code:
                result = self.out.temporary()
                self.out.emit(f"{result}={value.wrapped}")
                value = Val(result, value.type)
            self.arguments.take_output(enabled, MemoryPlace(bare_shape("BOOL"), local="E[0]"))
        return value

    def call_value(self, node: ast.Call) -> Val:
        """Compile a call inside an expression."""
        target = node.target
        if any((argument.name or "").upper() == "EN" for argument in node.arguments):
            self.context.error("PG827", "the soft CPU does not execute EN of a call with a value", node, "use IF")
        if isinstance(target, ast.Address) or (isinstance(target, ast.Member) and self.is_data(target)):
            place = self.places.place(node)
            return self.access.load(place) if place is not None else unknown()
        if isinstance(target, ast.Name) and not self.is_instance(target):
            found = self.context.link.find(target.name)
            if found is not None and found.block.kind is BlockKind.FC:
                return self.call_function(node, found)
            if target.scope == "bare":
                value = self.instruction(node, target.name.upper())
                if value is not None:
                    return value
            if found is None:
                self.missing_block(node, target)
                return unknown()
        self.context.error("PG821", f"{self.context.text(target)} has no value", node, "only functions have one")
        return unknown()

    def is_instance(self, target: ast.Name) -> bool:
        """Whether a name is an instance; another variable may be called like the function that is meant."""
        symbol = self.places.symbol(target)
        shape = symbol.place.shape if symbol is not None and symbol.place is not None else None
        return symbol is not None and (shape is None or target.scope == "local" or isinstance(shape.type, NamedType))

    def is_data(self, target: ast.Member) -> bool:
        """Whether a path such as ``%DB1.DW`` begins with a data block instead of an FB."""
        base = target.base
        if self.places.opened.is_number(base):
            return True
        if not isinstance(base, ast.Name) or self.places.symbol(base) is not None:
            return False
        found = self.context.link.find(base.name)
        named = found is not None and found.block.kind is BlockKind.DB
        return named and target.name.upper() in {"DW", "DB", "DD", "DX", "DBW", "DBB", "DBD", "DBX"}

    def near_block(self, name: str) -> str:
        """Return a hint with the nearest block name."""
        return did_you_mean(name, [block.name for block in self.context.link.blocks.values()])

    def call_statement(self, statement: ast.CallStatement) -> None:
        """Compile a call that stands alone."""
        names = [(argument.name or "").upper() for argument in statement.call.arguments]
        if "EN" in names and "ENO" not in names:
            self.enabled_call(statement, names.index("EN"))
            return
        node, target = statement.call, statement.call.target
        if isinstance(target, ast.Name) and not self.is_instance(target):
            found = self.context.link.find(target.name)
            if found is None and (target.scope == "bare" or target.name.upper() not in self.context.link.tags):
                value = self.instruction(node, target.name.upper()) if target.scope == "bare" else None
                if value is None:
                    self.missing_block(node, target)
                else:
                    self.discard(value)
                return
            if found is not None and found.block.kind in {BlockKind.FC, BlockKind.OB}:
                self.discard(self.call_function(node, found))
                return
        if (
            isinstance(target, ast.Member)
            and isinstance(target.base, ast.Name)
            and self.places.symbol(target.base) is None
        ):
            type_ = self.type_called(target.base.name)
            if type_:
                self.call_by_type(node, target, type_)
                return
        if (
            isinstance(target, ast.Member)
            and target.name.upper() in _METHODS
            and self.called_type(target.base) in _TIMER_TYPES
        ):
            place = self.places.place(target.base)
            if place is not None:
                self.call_instance(node, place, target.name.upper())
            return
        if (
            isinstance(target, ast.Member)
            and target.name.upper() in _FORMS
            and not self.context.classic
            and _LIKEWISE.fullmatch(self.called_type(target.base)) is not None
        ):
            self.context.error("PG827", f"the soft CPU does not execute {target.name} of this type", node)
            self.arguments.look_at(node)
            return
        place = self.places.place(target)
        if place is None or self.context.is_opaque(place.shape):
            self.arguments.look_at(node)
        else:
            type_ = place.shape.type.name if isinstance(place.shape.type, NamedType) else ""
            if isinstance(target, ast.Name) and place.mem.startswith("d"):
                found = self.context.link.find(target.name)
                type_ = self.context.link.instance_type(found) if found is not None else ""
            self.call_instance(node, place, type_)

    def enabled_call(self, statement: ast.CallStatement, position: int) -> None:
        """``EN := ..``: nothing happens if it is FALSE (help of the TIA Portal, EN/ENO mechanism in SCL)."""
        node = statement.call
        enable = node.arguments[position].value
        self.out.emit(f"if {truth(self.context, self.expressions.value(enable), enable)}:")
        self.out.indent += " "
        self.access.forget()
        begin = len(self.out.lines)
        others = (*node.arguments[:position], *node.arguments[position + 1 :])
        self.call_statement(replace(statement, call=replace(node, arguments=others)))
        if len(self.out.lines) == begin:
            self.out.emit("pass")
        self.out.indent = self.out.indent[:-1]
        self.access.forget()

    def called_type(self, node: ast.Expression) -> str:
        """Upper-case name of the type before the dot, also of a data block that is such an instance; empty if none."""
        if isinstance(node, ast.Name) and self.places.symbol(node) is None:
            found = self.context.link.find(node.name)
            if found is not None and found.block.kind is BlockKind.DB and found.block.instance_of:
                return found.block.instance_of.upper()
        place = self.places.place(node)
        type_ = place.shape.type if place is not None else None
        return type_.name.upper() if isinstance(type_, NamedType) else ""

    def missing_block(self, node: ast.Call, target: ast.Name) -> None:
        """PG825, or PG827 for a function of the language that the soft CPU does not have."""
        upper = target.name.upper()
        known = upper in INSTRUCTIONS or upper.rpartition("_")[0] in INSTRUCTIONS  # also NORM_X_REAL, SCALE_X_INT
        if target.scope == "bare" and (known or (upper[:3] == "SFC" and upper[3:].isdecimal())):
            self.context.error("PG827", f"the soft CPU does not execute {target.name}", node)
        else:
            near = self.near_block(target.name)
            self.context.unknown("PG825", f"there is no block {target.name}", (target.name,), node, near)
        self.arguments.look_at(node)

    def discard(self, value: Val) -> None:
        """Evaluate an expression for what it does."""
        if value.code and value.type != UNKNOWN and not value.code.isidentifier():
            self.out.emit(value.code)

    def type_called(self, name: str) -> str:
        """Upper-case name of the FB or system block before the dot of ``"FB"."DB"(..)``."""
        found = self.context.link.find(name)
        if found is not None:
            return found.name.upper() if found.block.kind is BlockKind.FB else ""
        return name.upper() if name.upper() in system_fbs(classic=self.context.classic) else ""

    def call_by_type(self, node: ast.Call, target: ast.Member, type_: str) -> None:
        """``"FB"."DB"(..)`` of STEP 7 V5."""
        found = self.context.link.find(target.name)
        if found is None or found.shape is None or found.block.kind is not BlockKind.DB:
            near = self.near_block(target.name)
            message = f"there is no instance data block {target.name}"
            self.context.unknown("PG825", message, (target.name,), node, near)
            self.arguments.look_at(node)
            return
        own = self.context.link.instance_type(found)
        systems = system_fbs(classic=self.context.classic)
        if own != type_ and systems.get(own) is not systems.get(type_):
            self.context.error("PG825", f"{target.name} is not an instance of {type_}", node)
            return
        self.call_instance(node, self.places.data_block(found), type_)

    def call_instance(self, node: ast.Call, place: MemoryPlace, type_: str) -> None:
        """Call an FB or system block with the instance at a place."""
        system = system_fbs(classic=self.context.classic).get(type_.upper())
        found = self.context.link.find(type_) if type_ else None
        if found is not None and found.block.kind is BlockKind.FB:
            sections = {m.name.upper(): s.kind for s in found.block.sections for m in s.members if m.at is None}
            allowed = {name: kind for name, kind in sections.items() if kind in {_IN, _OUT, _INOUT}}
            passed = self.arguments.pass_arguments(node, place, allowed, found)
            self.check_body(node, found)
            self.context.calling += 1
            self.context.calls.setdefault(found.name.upper(), self.context.span(node))
            self.watchdog.hand_over()
            if place.mem != "m" and place.fixed and place.off == 0:
                self.out.emit(f"{self.context.function(found.index)}({place.mem})")
            else:
                self.context.moving.add(found.name.upper())
                function = self.context.function(found.index, moving=True)
                self.out.emit(f"{function}({place.mem},{self.access.address(place)})")
            self.watchdog.take_back()
            self.context.called()
            self.access.forget()
            if passed is not None:
                self.arguments.give_back(passed.lent, node)
        elif system is not None:
            passed = self.arguments.pass_arguments(node, place, dict(system.parameters), system)
            if passed is not None:
                self.call_system(node, place, system, passed.buffer)
        else:
            known = system_block(type_, classic=self.context.classic) if type_ else None
            if known is not None and known.kind is BlockKind.FB:
                self.context.error("PG827", f"the soft CPU does not execute {type_}", node)
            else:
                self.context.error("PG825", f"{self.context.text(node.target)} is not an instance of a block", node)
            self.arguments.look_at(node)
            return
        if passed is not None and passed.outputs:
            self.context.point("output", node)
        for argument, output in passed.outputs if passed is not None else ():
            self.arguments.take_output(argument, output)

    def call_system(self, node: ast.Call, place: MemoryPlace, system: SystemFb, buffer: str) -> None:
        """Emit the call of a system block."""
        name = f"S_{system.block.name}"
        self.context.point("call", node)
        if not system.buffer:
            preset = f",{buffer}" if buffer else ""
            self.out.emit(f"{self.timer_guard(place, system)}{name}({place.mem},{self.access.address(place)}{preset})")
            if system.watched:
                self.access.forget()
            else:
                self.access.touched(place.region if place.fixed else None, place.off, place.shape.bits)
            return
        if not buffer:
            self.context.error("PG822", f"{system.buffer} is missing", node, "name the buffer in every call")
            return
        self.out.emit(f"{name}({place.mem},{self.access.address(place)},{buffer})")
        self.context.called()
        self.access.forget()

    def timer_guard(self, place: MemoryPlace, system: SystemFb) -> str:
        """Condition that leaves out the call of a TON whose IN, Q and state are all zero: it does nothing."""
        index = place.shape.index
        if system.kind != "TON":
            return ""
        flags = sorted({index[name].offset // 8 for name in ("IN", "Q", "STATE") if name in index})
        codes = (self.access.address(place.inside(byte * 8, place.shape, overlay=False)) for byte in flags)
        return f"if {' or '.join(f'{place.mem}[{code}]' for code in codes)}:"

    def check_body(self, node: ast.Call, found: ProgramBlock) -> None:
        """PG827 about the call of a block whose code was not read."""
        if found.skipped:
            self.context.error("PG827", f"the code of {found.name} is a statement list", node)

    def call_function(self, node: ast.Call, found: ProgramBlock) -> Val:
        """Call an FC: scalars by value, the rest by reference; outputs come back as a tuple."""
        self.check_body(node, found)
        self.context.calls.setdefault(found.name.upper(), self.context.span(node))
        parameters = function_parameters(found.block)
        allowed: dict[str, SectionKind] = {m.name.upper(): kind for kind, m, _ in parameters}
        allowed = {name: kind for name, kind in allowed.items() if kind is not SectionKind.RETURN}
        given = self.arguments.named_arguments(node, parameters, allowed)
        codes: list[str] = []
        values: list[tuple[int, Val, str, ast.Expression]] = []
        pending, before = self.context.pending, len(self.context.pending)
        lent: list[tuple[str, str]] = []
        after: list[tuple[ast.Argument | None, str]] = []
        result = ""
        for kind, member, how in parameters:
            argument = given.get(member.name.upper()) if kind is not SectionKind.RETURN else None
            type_ = member.type.name if isinstance(member.type, Elementary) else ""
            if kind is SectionKind.RETURN:
                result = member.type.name if isinstance(member.type, Elementary | StringType) else UNKNOWN
                continue
            if argument is None:
                self.context.error("PG822", f"{member.name} is missing", node, f"{found.name} needs every parameter")
                del pending[before:]
                return unknown()
            if how == "reference":
                code = self.arguments.structured(argument, kind, member.type)
                codes.append(self.arguments.lend(code, found, lent) if kind is _INOUT else code)
            elif how == "pointer" or (type_ == "ANY" and kind is _IN and self.arguments.kind_of(argument) != "ANY"):
                codes.append(self.references.reference(argument.value, typed=isinstance(member.type, NamedType)))
            elif kind is not _OUT:
                values.append((len(codes), self.expressions.value(argument.value), type_, argument.value))
                pending.append(values[-1][1])
                codes.append("")
            elif self.context.classic:
                codes.append(self.arguments.found_in_output(argument, type_))
            if how == "value" and kind is not _IN:
                after.append((argument, type_))
        del pending[before:]
        for position, value, type_, expression in values:
            codes[position] = coerce(self.context, value, type_, expression)
        value = self.emit_function(found, codes, after, result)
        enabled = given.get("ENO")
        if enabled is not None and "ENO" not in allowed:
            self.arguments.take_output(enabled, MemoryPlace(bare_shape("BOOL"), local="E[0]"))
        self.arguments.give_back(lent, node)
        return value

    def emit_function(
        self, found: ProgramBlock, codes: list[str], after: list[tuple[ast.Argument | None, str]], result: str
    ) -> Val:
        """Emit the call and take the outputs."""
        self.context.calling += 1
        self.context.settle()
        call = f"{self.context.function(found.index)}({','.join(codes)})"
        self.watchdog.hand_over()
        name = self.out.temporary()
        self.out.emit(f"{name}={call}")
        self.watchdog.take_back()
        self.context.called()
        self.access.forget()
        if after:
            for position, (argument, type_) in enumerate(after):
                if argument is not None:
                    place = self.arguments.place_of_argument(argument)
                    if place is not None:
                        self.assignments.assign_value(place, Val(f"{name}[{position + 1}]", type_), argument.value)
            return Val(f"{name}[0]", result) if result else Val(name, "")
        return Val(name, result)

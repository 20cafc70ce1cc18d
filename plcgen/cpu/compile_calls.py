"""Calls: instances of function blocks, system function blocks, functions of the program."""

from __future__ import annotations

from plcgen.cpu.compile_arguments import ArgumentCompiler
from plcgen.cpu.compile_model import UNKNOWN, Place, ProgramBlock, Val
from plcgen.cpu.semantics_scope import is_pointer, is_scalar, scalar_name
from plcgen.cpu.system.interfaces import SystemFb, system_fbs
from plcgen.diagnostics.suggest import did_you_mean
from plcgen.s7.blocks import BlockKind, SectionKind
from plcgen.s7.shapes import Shape
from plcgen.s7.types import Elementary, Member, NamedType, StringType
from plcgen.scl import ast
from plcgen.scl.instructions import INSTRUCTIONS

_METHODS = frozenset({"TON", "TOF", "TP"})
_TIMER_TYPES = frozenset({"IEC_TIMER", *(f"{name}_TIME" for name in _METHODS)})
"""Types of one layout that are called as ``timer.TON(..)`` on an S7-1200/1500."""
_IN, _OUT, _INOUT = SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT


class CallCompiler(ArgumentCompiler):
    """Everything with parentheses behind a name."""

    in_loop = 0

    def function(self, node: ast.Call, name: str) -> Val | None:
        """Compile a function of the language; the next class knows them. None if there is no such one."""
        raise NotImplementedError

    # --- finding out what is called -------------------------------------------------------------------

    def call_value(self, node: ast.Call) -> Val:
        """Compile a call inside an expression."""
        target = node.target
        if isinstance(target, ast.Address) or (isinstance(target, ast.Member) and self.is_data(target)):
            place = self.called_address(node)
            return self.load(place) if place is not None else self.unknown()
        if isinstance(target, ast.Name) and self.symbol(target) is None:
            found = self.link.find(target.name)
            if found is not None and found.block.kind is BlockKind.FC:
                return self.call_function(node, found)
            if target.scope == "bare":
                value = self.function(node, target.name.upper())
                if value is not None:
                    return value
            if found is None:
                self.missing_block(node, target)
                return self.unknown()
        self.error("PG821", f"{self.text(target)} has no value", node, "only functions have one")
        return self.unknown()

    def is_data(self, target: ast.Member) -> bool:
        """Whether a path such as ``%DB1.DW`` begins with a data block instead of an FB."""
        base = target.base
        found = self.link.find(base.name) if isinstance(base, ast.Name) and self.symbol(base) is None else None
        named = found is not None and found.block.kind is BlockKind.DB
        return named and target.name.upper() in {"DW", "DB", "DD", "DX", "DBW", "DBB", "DBD", "DBX"}

    def near_block(self, name: str) -> str:
        """Return a hint with the nearest block name."""
        return did_you_mean(name, [block.name for block in self.link.blocks.values()])

    def call_statement(self, node: ast.Call) -> None:
        """Compile a call that stands alone."""
        target = node.target
        if isinstance(target, ast.Name) and self.symbol(target) is None:
            found = self.link.find(target.name)
            if found is None and (target.scope == "bare" or target.name.upper() not in self.link.tags):
                self.plain_call(node, target)
                return
            if found is not None and found.block.kind in {BlockKind.FC, BlockKind.OB}:
                self.discard(self.call_function(node, found))
                return
        if isinstance(target, ast.Member) and isinstance(target.base, ast.Name) and self.symbol(target.base) is None:
            type_ = self.type_called(target.base.name)
            if type_:
                self.call_by_type(node, target, type_)
                return
        if isinstance(target, ast.Member) and target.name.upper() in _METHODS and self.is_timer(target.base):
            place = self.place(target.base)
            if place is not None:
                self.call_instance(node, place, target.name.upper())
            return
        place = self.place(target)
        if place is not None:
            type_ = place.shape.type.name if isinstance(place.shape.type, NamedType) else ""
            if isinstance(target, ast.Name) and place.mem.startswith("d"):
                found = self.link.find(target.name)
                type_ = self.link.instance_type(found) if found is not None else ""
            self.call_instance(node, place, type_)

    def is_timer(self, node: ast.Expression) -> bool:
        """Whether ``x`` of ``x.TON(..)`` is an IEC_TIMER of its own or in a data block."""
        if isinstance(node, ast.Name) and self.symbol(node) is None:
            found = self.link.find(node.name)
            if found is not None and found.block.kind is BlockKind.DB and found.block.instance_of:
                return found.block.instance_of.upper() in _TIMER_TYPES
        place = self.place(node)
        return (
            place is not None
            and isinstance(place.shape.type, NamedType)
            and (place.shape.type.name.upper() in _TIMER_TYPES)
        )

    def plain_call(self, node: ast.Call, target: ast.Name) -> None:
        """Compile a function of the language whose value nobody wants, or report a missing block."""
        value = self.function(node, target.name.upper()) if target.scope == "bare" else None
        if value is None:
            self.missing_block(node, target)
        else:
            self.discard(value)

    def missing_block(self, node: ast.Call, target: ast.Name) -> None:
        """PG825, or PG827 for a function of the language that the soft CPU does not have."""
        upper = target.name.upper()
        if target.scope == "bare" and (upper in INSTRUCTIONS or (upper[:3] == "SFC" and upper[3:].isdecimal())):
            self.error("PG827", f"the soft CPU does not execute {target.name}", node)
            return
        self.error("PG825", f"there is no block {target.name}", node, self.near_block(target.name))

    def discard(self, value: Val) -> None:
        """Evaluate an expression for what it does."""
        if value.code and value.type != UNKNOWN and not value.code.isidentifier():
            self.emit(value.code)

    def type_called(self, name: str) -> str:
        """Upper-case name of the FB or system block before the dot of ``"FB"."DB"(..)``."""
        found = self.link.find(name)
        if found is not None:
            return found.name.upper() if found.block.kind is BlockKind.FB else ""
        return name.upper() if name.upper() in system_fbs(classic=self.classic) else ""

    def call_by_type(self, node: ast.Call, target: ast.Member, type_: str) -> None:
        """``"FB"."DB"(..)`` of STEP 7 V5."""
        found = self.link.find(target.name)
        if found is None or found.shape is None or found.block.kind is not BlockKind.DB:
            self.error("PG825", f"there is no instance data block {target.name}", node, self.near_block(target.name))
            return
        own = self.link.instance_type(found)
        systems = system_fbs(classic=self.classic)
        if own != type_ and systems.get(own) is not systems.get(type_):
            self.error("PG825", f"{target.name} is no instance of {type_}", node)
            return
        self.call_instance(node, self.data_block(found), type_)

    # --- instances ------------------------------------------------------------------------------------

    def call_instance(self, node: ast.Call, place: Place, type_: str) -> None:
        """Call an FB or system block with the instance at a place."""
        system = system_fbs(classic=self.classic).get(type_.upper())
        found = self.link.find(type_) if type_ else None
        if found is not None and found.block.kind is BlockKind.FB:
            sections = {m.name.upper(): s.kind for s in found.block.sections for m in s.members if m.at is None}
            allowed = {name: kind for name, kind in sections.items() if kind in {_IN, _OUT, _INOUT}}
            after = self.pass_arguments(node, place, allowed)
            self.call_user(node, place, found)
        elif system is not None:
            after = self.pass_arguments(node, place, dict(system.parameters), system=system)
            if after is None:
                return
            self.call_system(node, place, system)
        else:
            self.error("PG825", f"{self.text(node.target)} is no instance of a block", node)
            return
        for argument, field in after or []:
            self.take_output(argument, field)

    def call_user(self, node: ast.Call, place: Place, found: ProgramBlock) -> None:
        """Emit the call of an FB of the program."""
        self.calls.setdefault(found.name.upper(), self.span(node))
        self.sync_watchdog()
        if place.mem != "m" and place.fixed and place.off == 0:
            self.emit(f"b{found.index}({place.mem})")
        else:
            self.moving = True
            self.emit(f"b{found.index}o({place.mem},{self.address(place)})")
        self.resume_watchdog()
        self.forget()

    record_code = ""

    def call_system(self, node: ast.Call, place: Place, system: SystemFb) -> None:
        """Emit the call of a system block."""
        name = f"S_{system.block.name}"
        if not system.buffer:
            self.emit(f"{self.timer_guard(place, system)}{name}({place.mem},{self.address(place)})")
            if system.watched:
                self.forget()
            else:
                self.touched(place.region if place.fixed else None, place.off, place.shape.bits)
            return
        if not self.record_code:
            self.error("PG822", f"{system.buffer} is missing", node, "name the buffer in every call")
            return
        self.emit(f"{name}({place.mem},{self.address(place)},{self.record_code})")
        self.record_code = ""
        self.forget()

    def timer_guard(self, place: Place, system: SystemFb) -> str:
        """Condition that leaves out the call of a TON whose IN, Q and state are all zero: it does nothing."""
        index = place.shape.index
        if system.kind != "TON":
            return ""
        flags = sorted({index[name].offset // 8 for name in ("IN", "Q", "STATE") if name in index})
        codes = (self.address(self.shifted(place, byte * 8, place.shape, overlay=False)) for byte in flags)
        return f"if {' or '.join(f'{place.mem}[{code}]' for code in codes)}:"

    def sync_watchdog(self) -> None:
        """Hand the count of loop passes to what is called."""
        if self.in_loop:
            self.emit("W[0]=n")

    def resume_watchdog(self) -> None:
        """Take the count of loop passes back."""
        if self.in_loop:
            self.emit("n=W[0]")

    # --- arguments ------------------------------------------------------------------------------------

    def pass_arguments(
        self, node: ast.Call, place: Place, allowed: dict[str, SectionKind], system: SystemFb | None = None
    ) -> list[tuple[ast.Argument, Place]] | None:
        """Store inputs; return the outputs that are wanted after the call."""
        after: list[tuple[ast.Argument, Place]] = []
        seen: set[str] = set()
        for argument in node.arguments:
            upper = (argument.name or "").upper()
            if upper in {"EN", "ENO"} and upper not in allowed:
                self.enable(argument, upper, after)
                continue
            kind = self.parameter(argument, upper, allowed, seen)
            if kind is None or isinstance(argument.value, ast.Omitted):
                continue
            if system is not None and upper == system.buffer:
                self.record_code = self.reference(argument.value)
                continue
            field = self.field(place, upper, argument.value)
            if field is None:
                continue
            if kind is not _OUT:
                self.pass_input(argument, field, kind)
            if kind is _OUT or (kind is _INOUT and scalar_name(field.shape) not in {"POINTER", "ANY", ""}):
                after.append((argument, field))
        missing = [name for name, kind in allowed.items() if kind is _INOUT and name not in seen]
        if missing and self.link.dialect.is_tia:
            self.error("PG822", f"{missing[0]} is missing", node, "every IN_OUT parameter needs a variable")
            if system is not None:
                return None
        return after

    def parameter(
        self, argument: ast.Argument, upper: str, allowed: dict[str, SectionKind], seen: set[str]
    ) -> SectionKind | None:
        """Section of a named parameter; PG822 if it is none or the operator is wrong."""
        kind = allowed.get(upper)
        if kind is None:
            shown = argument.name or self.text(argument)
            self.error("PG822", f"the block has no parameter {shown}", argument, did_you_mean(shown, list(allowed)))
            return None
        if upper in seen:
            self.error("PG822", f"{argument.name} is given twice", argument)
            return None
        seen.add(upper)
        if (argument.operator == "=>") != (kind is _OUT):
            wanted = "=>" if kind is _OUT else ":="
            self.error("PG822", f"{argument.name} is an {kind.value} parameter: it goes with {wanted}", argument)
            return None
        return kind

    def enable(self, argument: ast.Argument, upper: str, after: list[tuple[ast.Argument, Place]]) -> None:
        """EN and ENO of a call."""
        if upper == "ENO":
            after.append((argument, Place(Shape(Elementary("BOOL", 1), 1, 1, 1, 1), local="E[0]")))
        else:
            self.error("PG827", "the soft CPU does not execute EN of a call", argument, "use IF")

    # --- functions of the program ---------------------------------------------------------------------

    def call_function(self, node: ast.Call, found: ProgramBlock) -> Val:
        """Call an FC: scalars by value, the rest by reference; outputs come back as a tuple."""
        self.calls.setdefault(found.name.upper(), self.span(node))
        parameters = function_parameters(found)
        allowed: dict[str, SectionKind] = {m.name.upper(): kind for kind, m, _ in parameters}
        allowed = {name: kind for name, kind in allowed.items() if kind is not SectionKind.RETURN}
        given = self.named_arguments(node, parameters, allowed)
        codes: list[str] = []
        after: list[tuple[ast.Argument | None, str]] = []
        result = ""
        for kind, member, how in parameters:
            argument = given.get(member.name.upper()) if kind is not SectionKind.RETURN else None
            type_ = member.type.name if isinstance(member.type, Elementary) else ""
            if kind is SectionKind.RETURN:
                result = member.type.name if isinstance(member.type, Elementary | StringType) else UNKNOWN
                continue
            if argument is None:
                self.error("PG822", f"{member.name} is missing", node, f"{found.name} needs every parameter")
                return self.unknown()
            if how == "reference":
                codes.append(self.structured(argument, kind))
            elif how == "pointer":
                codes.append(self.reference(argument.value))
            elif kind is not _OUT:
                codes.append(self.coerce(self.expression(argument.value), type_, argument.value))
            if how == "value" and kind is not _IN:
                after.append((argument, type_))
        return self.emit_function(found, codes, after, result)

    def structured(self, argument: ast.Argument, kind: SectionKind) -> str:
        """Memory and offset of an argument passed by reference."""
        if kind is not _IN and self.place_of_argument(argument) is None:
            return "(None,0,0)"
        return self.reference(argument.value)

    def emit_function(
        self, found: ProgramBlock, codes: list[str], after: list[tuple[ast.Argument | None, str]], result: str
    ) -> Val:
        """Emit the call and take the outputs."""
        call = f"b{found.index}({','.join(codes)})"
        self.sync_watchdog()
        name = self.temporary()
        self.emit(f"{name}={call}")
        self.resume_watchdog()
        self.forget()
        if after:
            for position, (argument, type_) in enumerate(after):
                if argument is not None:
                    place = self.place_of_argument(argument)
                    if place is not None:
                        self.assign_value(place, Val(f"{name}[{position + 1}]", type_), argument.value)
            return Val(f"{name}[0]", result) if result else Val(name, "")
        return Val(name, result)

    def named_arguments(
        self, node: ast.Call, parameters: list[tuple[SectionKind, Member, str]], allowed: dict[str, SectionKind]
    ) -> dict[str, ast.Argument]:
        """Arguments by upper-case parameter name; a single one may go without a name."""
        if len(node.arguments) == 1 and node.arguments[0].name is None and len(allowed) == 1:
            return {parameters[0][1].name.upper(): node.arguments[0]}
        seen: set[str] = set()
        given: dict[str, ast.Argument] = {}
        for argument in node.arguments:
            upper = (argument.name or "").upper()
            if upper in {"EN", "ENO"} and upper not in allowed:
                continue
            v5_output = allowed.get(upper) is _OUT and argument.operator == ":=" and not self.link.dialect.is_tia
            kind = allowed[upper] if v5_output and upper not in seen else self.parameter(argument, upper, allowed, seen)
            if kind is not None:
                seen.add(upper)
                if not isinstance(argument.value, ast.Omitted):
                    given[upper] = argument
        return given


def function_parameters(found: ProgramBlock) -> list[tuple[SectionKind, Member, str]]:
    """Parameters of an FC in the order of its Python arguments, and how each is passed."""
    rows: list[tuple[SectionKind, Member, str]] = []
    for kind in (_IN, _OUT, _INOUT, SectionKind.RETURN):
        members = found.block.section(kind)
        viewed = {m.at.strip('"#').upper() for m in members if m.at is not None}
        for member in members:
            if member.at is not None:
                continue
            scalar = is_scalar(member.type) and member.name.upper() not in viewed
            rows.append((kind, member, "value" if scalar else "pointer" if is_pointer(member) else "reference"))
    return rows

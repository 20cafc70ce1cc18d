"""Jobs as their caller sees them: structures of the control DB, flags, calls and lines of a watch table."""

from __future__ import annotations

from collections.abc import Iterator

from plcgen.build.members import plain
from plcgen.build.nouns import Call, Command, FunctionBlock, MemberRow, TagRow, WatchRow
from plcgen.build.spelling import type_words
from plcgen.project.nouns import Frame, OwnSymbol, flag_name
from plcgen.s7.types.address import Address

_SIGNALS = {
    "execute": ("BOOL", "a rising edge starts the job"),
    "busy": ("BOOL", "the job is running"),
    "done": ("BOOL", "the job ended well"),
    "error": ("BOOL", "the job failed"),
    "status": ("WORD", "result of the job"),
}


def signals(frame: Frame, texts: dict[str, str] | None = None, *, starts: bool = False) -> list[MemberRow]:
    """The signals that every job has; ``texts`` replaces comments, ``starts`` says that execute is TRUE at start."""
    words = type_words(tia=not frame.target.v5)
    return [
        plain(frame, name, words[type_], (texts or {}).get(name, text), "TRUE" if starts and name == "execute" else "")
        for name, (type_, text) in _SIGNALS.items()
    ]


def signal_operand(command: Command, name: str) -> str:
    """Operand of a signal or value: its flag or symbol, else its member of the control DB."""
    flag = command.flags.get(name)
    if flag is not None:
        return flag.text() if isinstance(flag, OwnSymbol) else f'"{flag_name(command.prefix, command.member, name)}"'
    return f'"{command.control.name}".{command.member}.{name}'


def structure(frame: Frame, command: Command) -> MemberRow:
    """A job's structure in the control DB: what the trigger does not place in flags, and the values.

    It may have no members: an empty structure is not declared.
    """
    inner = [signal for signal in command.signals if signal.name not in command.flags]
    values = [value.member for value in (*command.inputs, *command.outputs, *command.shared)]
    return plain(frame, command.member, "Struct", command.title)._replace(members=(*inner, *values))


def placeholder(frame: Frame) -> MemberRow:
    """What a control DB holds if no job has anything there: a data block has at least one member."""
    return plain(frame, "unused", type_words(tia=not frame.target.v5)["BOOL"], "every signal of every job is a flag")


def tags(command: Command) -> list[TagRow]:
    """The absolute flags of a job."""
    return [
        TagRow(
            flag_name(command.prefix, command.member, signal),
            "Word" if address.width_bits > 1 else "Bool",
            address.text(percent=False),
            f"{signal}: {command.title}",
        )
        for signal, address in command.flags.items()
        if isinstance(address, Address)
    ]


def watch_rows(command: Command) -> Iterator[WatchRow]:
    """Signals and values of a job."""
    for signal in command.signals:
        address = command.flags.get(signal.name)
        yield WatchRow(
            signal_operand(command, signal.name),
            address.text(percent=False) if isinstance(address, Address) else "",
            "Hex" if signal.name == "status" else "Bool",
            "",  # "Modify all" of a table that sets execute would start every drive
        )
    for value in (*command.inputs, *command.outputs, *command.shared):
        for suffix, shown in value.shown:
            yield WatchRow(signal_operand(command, value.member.name) + suffix, "", shown, "")


def call(program: FunctionBlock) -> Call | None:
    """The call of a function block with every command of its jobs; none if its instances lie in another block."""
    if program.instance is None:
        return None
    inputs: list[str] = []
    outputs: list[tuple[str, str]] = []
    for command in program.commands:
        execute, *results = [signal.name for signal in command.signals]
        names = [execute, *(value.member.name for value in command.inputs)]
        inputs += [f"{command.pin(name)} := {signal_operand(command, name)}" for name in names]
        names = [*results, *(value.member.name for value in command.outputs)]
        outputs += [(command.pin(name), signal_operand(command, name)) for name in names]
    return Call(program.title, program.block.name, program.instance.name, program.open_call, inputs, outputs)

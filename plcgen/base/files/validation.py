"""Data from outside -> pydantic model; every problem of a file becomes a diagnostic at its line and column, in one run.

A reader states the shape of its file as models derived from ``StrictModel`` and calls ``read_document``. What a type
cannot say is said by a validator that raises ``problem(...)``, or ``Problems`` for several places at once. The keys
that a message offers are those of the model at that place.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from types import MappingProxyType, UnionType
from typing import Annotated, Any, ClassVar, Generic, TypeVar, Union, get_args, get_origin

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    RootModel,
    ValidationError,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    WrapValidator,
)
from pydantic_core import InitErrorDetails, PydanticCustomError

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Report, Span
from plcgen.base.diagnostics.suggest import did_you_mean
from plcgen.base.files.yaml import YamlNode, parse_yaml, plain_node, resolve_plain

Path = tuple[str | int, ...]
Model = TypeVar("Model", bound=BaseModel)


class StrictModel(BaseModel):
    """What every part of a file is: known keys only, no conversions, unchangeable; built when first used.

    ``FOREIGN`` are keys that are none here but mean something elsewhere, with what is written instead.
    """

    FOREIGN: ClassVar[Mapping[str, str]] = MappingProxyType({})
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, protected_namespaces=(), defer_build=True)


@dataclass(frozen=True, slots=True)
class FileShape(Generic[Model]):
    """A kind of file.

    ``what`` names its top level in messages ("the spec"), ``shape`` says what stands there, ``help`` how to get one.
    ``keys`` overrides where the keys of a message come from. ``prepare`` widens short forms of the tree.
    """

    model: Callable[[YamlNode], type[Model]] | type[Model]
    what: str
    shape: str
    help: str = ""
    keys: Callable[[Path], list[str]] | None = None
    prepare: Callable[[YamlNode], YamlNode] | None = None


@dataclass(frozen=True, slots=True)
class Loaded(Generic[Model]):
    """A valid file: its model, and the tree with the place of every value."""

    model: Model
    root: YamlNode


def read_document(
    text: str, file: str, document: FileShape[Model], report: Report, context: Mapping[str, Any] | None = None
) -> Loaded[Model] | None:
    """Parse and validate the text of a file; problems go to ``report``; None if it cannot be used.

    ``context`` is what validators must know from outside the file; they find it as ``info.context``.
    """
    own = Report()
    root = parse_yaml(text, file, own)
    if root is None and not own.has_errors:
        own.add(Diagnostic("PG101", "the file is empty", Span(file, 1, 1, 1, 1), help=document.help))
    if root is not None and document.prepare is not None:
        root = document.prepare(root)
    valid = None if root is None else validate(root, document, own, context)
    report.extend(own)
    return None if root is None or valid is None or own.has_errors else Loaded(valid, root)


def load_document(
    text: str, file: str, document: FileShape[Model], context: Mapping[str, Any] | None = None
) -> Loaded[Model]:
    """Parse and validate the text of a file.

    Raises:
        DiagnosticError: with every problem of the file.
    """
    report = Report()
    loaded = read_document(text, file, document, report, context)
    report.raise_on_errors()
    assert loaded is not None  # raise_on_errors leaves only this case
    return loaded


def validate(
    root: YamlNode, document: FileShape[Model], report: Report, context: Mapping[str, Any] | None = None
) -> Model | None:
    """Validate a tree; problems go to ``report``, but none where it has one already; None if there are any."""
    if root.kind != "map":
        report.add(Diagnostic("PG106", document.shape, root.span, help=document.help))
        return None
    chosen = document.model
    model: type[Model] = chosen if isinstance(chosen, type) else chosen(root)
    try:
        return model.model_validate(root.data(), context=context)
    except ValidationError as problems:
        known = {(found.span.line, found.span.column) for found in report}
        keys = document.keys or (lambda path: keys_at(model, path))
        told = _Teller(root, document.what, keys, model).diagnostics(problems.errors(include_url=False))
        report.extend(found for found in told if (found.span.line, found.span.column) not in known)
        return None


def validate_option(
    entry: Mapping[str, Any], option: str, document: FileShape[Model], context: Mapping[str, Any] | None = None
) -> Model:
    """Validate what an option of the command line says, ``option`` as it was typed.

    Raises:
        DiagnosticError: PG901 for everything wrong.
    """
    report = Report()
    valid = validate(plain_node(entry, Span(option)), document, report, context)
    if valid is None:
        raise DiagnosticError(replace(found, code="PG901") for found in report)
    return valid


_CUSTOM = "problem"


def problem(message: str, *, code: str = "PG107", help_: str = "", at_key: bool = False) -> PydanticCustomError:
    """What a validator raises: the diagnostic's own words; its place is the value's, or its key's."""
    return PydanticCustomError(_CUSTOM, "{message}", {"message": message, "code": code, "help": help_, "key": at_key})


def counting(value: Any, info: ValidationInfo, kinds: Mapping[Any, tuple[str, tuple[str, ...]]]) -> Any:
    """The value of a key of a fault, if it counts for its kind: a key that counts for none does for all of them."""
    kind, key = info.data.get("kind"), info.field_name
    if kind is None or value is None or not any(key in keys for _, keys in kinds.values()) or key in kinds[kind][1]:
        return value
    own = ", ".join(kinds[kind][1])
    help_ = f"keys of it: {own}" if own else "leave it out"
    raise problem(f'"{key}" does nothing for the fault {kind.value}', help_=help_)


@dataclass(slots=True)
class Problems:
    """Several problems of one value, each at a path below it; a validator raises them together."""

    found: list[InitErrorDetails] = field(default_factory=list)

    def add(self, error: PydanticCustomError, *path: str | int) -> None:
        """Note a problem."""
        self.found.append(InitErrorDetails(type=error, loc=path, input=None))

    @contextmanager
    def at(self, *path: str | int) -> Iterator[None]:
        """Note what is raised meanwhile as a problem at a path."""
        try:
            yield
        except PydanticCustomError as error:
            self.add(error, *path)

    def add_all(self, invalid: ValidationError) -> None:
        """Note what another validation found."""
        for error in invalid.errors(include_url=False):
            words = {**error.get("ctx", {}), "message": error["msg"]}
            self.add(PydanticCustomError(error["type"], "{message}", words), *error["loc"])

    def raise_any(self) -> None:
        """Raise what was noted, if anything was."""
        if self.found:
            raise ValidationError.from_exception_data("problems", self.found)


def unique(key: str, message: str, default: Any = None) -> WrapValidator:
    """Validator of a list of mappings that differ in ``key``: ``message`` gets the value that comes twice."""

    def check(entries: Any, handler: ValidatorFunctionWrapHandler) -> Any:
        problems, seen, valid = Problems(), set[str](), None
        try:
            valid = handler(entries)
        except ValidationError as invalid:
            problems.add_all(invalid)
        for index, entry in enumerate(entries if isinstance(entries, tuple) else ()):
            value = entry.get(key, default) if isinstance(entry, dict) else None
            if isinstance(value, int | str) and str(value) in seen:
                problems.add(problem(message.format(value)), index, key)
            seen.add(str(value))
        problems.raise_any()
        return valid

    return WrapValidator(check)


def _octets(text: object) -> object:
    try:
        return bytes.fromhex(text) if isinstance(text, str) else text
    except ValueError:
        raise problem("bytes are hexadecimal text", help_='for example "01 0A FF"') from None


Octets = Annotated[bytes, BeforeValidator(_octets)]
"""Bytes, written as hexadecimal text."""


def keys_at(model: type[BaseModel], path: Iterable[str | int]) -> list[str]:
    """Keys that a file may have at a path, in the order of the model; none if a value stands there."""
    models = [part for part in _at(model, path) if _is_model(part)]
    return list(dict.fromkeys(info.alias or name for part in models for name, info in part.model_fields.items()))


def description_at(model: type[BaseModel], path: Path) -> str:
    """What the field at a path is for, in the words of the model; empty if a key that the user chose stands there."""
    fields = (part.model_fields for part in _at(model, path[:-1]) if _is_model(part))
    infos = (info for each in fields for name, info in each.items() if path[-1] in {info.alias, name})
    return next((info.description for info in infos if info.description), "")


def _at(model: type[BaseModel], path: Iterable[str | int]) -> Iterator[Any]:
    """The types that may stand at a path."""
    found: list[Any] = [model]
    for step in path:
        found = [below for kind in found for part in _parts(kind) for below in _below(part, step)]
    return (part for kind in found for part in _parts(kind))


def _is_model(part: Any) -> bool:
    return isinstance(part, type) and issubclass(part, BaseModel)


def _parts(annotation: Any) -> Iterator[Any]:
    """The alternatives of a type, without what is annotated to it."""
    origin = get_origin(annotation)
    if origin is Annotated:
        yield from _parts(get_args(annotation)[0])
    elif origin in {Union, UnionType}:
        for alternative in get_args(annotation):
            yield from _parts(alternative)
    elif _is_model(annotation) and issubclass(annotation, RootModel):
        yield from _parts(annotation.model_fields["root"].annotation)
    else:
        yield annotation


def _below(part: Any, step: str | int) -> Iterator[Any]:
    """Types of what stands one step below a model, mapping or list."""
    if _is_model(part):
        yield from (info.annotation for name, info in part.model_fields.items() if step in {info.alias, name})
    elif get_origin(part) is dict:
        yield get_args(part)[1]
    elif get_origin(part) in {tuple, list, frozenset} and isinstance(step, int):
        yield get_args(part)[0]


_TIME = re.compile(r"[0-9]+\s*(ms|s|min|h)")
_SHOULD = re.compile(r"\A[a-z]+ should (be|have)")
_RANGE_ERRORS = (
    "greater_than", "less_than", "too_short", "too_long", "value_error",
    "string_too", "string_pattern", "finite",
)  # fmt: skip
_EXPECTED = {
    "string_type": "text", "int_type": "a whole number", "int_from_float": "a whole number", "float_type": "a number",
    "bool_type": "true or false", "dict_type": "a mapping", "model_type": "a mapping", "tuple_type": "a list",
    "list_type": "a list", "bytes_type": "hexadecimal text in quotes",
}  # fmt: skip


@dataclass(frozen=True, slots=True)
class _Teller:
    """Puts pydantic's errors into words, each at its place in the tree."""

    root: YamlNode
    what: str
    keys: Callable[[Path], list[str]]
    model: type[BaseModel]

    def diagnostics(self, errors: Iterable[Any]) -> list[Diagnostic]:
        """One diagnostic per value: the alternatives of a union are one problem, not several."""
        by_value: dict[tuple[int, str], list[Any]] = {}
        errors = list(errors)
        above = {error["loc"][:depth] for error in errors for depth in range(len(error["loc"]))}
        unknown = [error["loc"] for error in errors if error["type"] == "extra_forbidden"]
        capitals = {(*loc[:-1], str(loc[-1]).lower()) for loc in unknown} - set(unknown)
        inside = {error["loc"][:depth] for error in errors for depth in range(len(error["loc"]) - 1)}
        for error in errors:
            if error["type"] == "too_short" and error["loc"] in above:
                continue  # pydantic does not count elements that are wrong
            if error["type"] == "missing" and error["loc"] in capitals:
                continue  # it is there, in capitals
            if error["type"] in _EXPECTED and error["loc"][:-1] in inside and self.is_alternative(error["loc"]):
                continue  # another alternative is of the right kind, and something is wrong in there
            named = error["type"] in {"extra_forbidden", "missing", _CUSTOM}
            detail = f"{error['type']} {error['loc'][-1:]} {error['msg']}" if named else ""
            by_value.setdefault((id(self.root.find(error["loc"])), detail), []).append(error)
        return [self.one(group) for group in by_value.values()]

    def is_alternative(self, path: Path) -> bool:
        """Whether the last step of a path is none in the tree: pydantic names the alternative of a union there."""
        return self.root.find(path) is self.root.find(path[:-1])

    def one(self, group: list[Any]) -> Diagnostic:
        error = next((e for e in group if e["type"] not in _EXPECTED), group[0])  # the alternative of the right kind
        path: Path = tuple(error["loc"])
        if error["type"] == "extra_forbidden":
            return self.unknown_key(path)
        if error["type"] == "missing":
            node = self.root.find(path[:-1])
            keys = ", ".join(self.keys(path[:-1]))
            message = f'{self.where(path)} lacks the key "{path[-1]}"'
            return Diagnostic("PG105", message, node.span, help=f"keys here: {keys}")
        if error["type"] == _CUSTOM:
            return self.custom(path, error["ctx"])
        node = self.root.find(path)
        given = f" instead of {_shown(node)}"
        if len(group) > 1 and all(e["type"] in _EXPECTED for e in group):
            wanted = " or ".join(dict.fromkeys(_EXPECTED[e["type"]] for e in group))
            return Diagnostic("PG106", f"expected {wanted}{given}", node.span, help=self.meaning(path))
        if error["type"] in _EXPECTED:
            number = isinstance(node.value, str) and not node.plain and isinstance(resolve_plain(node.raw), int | float)
            help_ = "remove the quotes" if number else ""
            if error["type"] in {"tuple_type", "list_type"}:
                written = node.raw if node.plain else f'"{node.raw}"'
                help_ = f"write [{written}]" if node.raw else "put it in [ ], or each on a line of its own: - one"
            if _EXPECTED[error["type"]] == "a mapping" and _shown(node) == "a list":
                help_ = f"write a key, a colon and what belongs to it, without a dash; {self.meaning(path)}".strip("; ")
            help_ = help_ or self.meaning(path)
            return Diagnostic("PG106", f"expected {_EXPECTED[error['type']]}{given}", node.span, help=help_)
        if error["type"] in {"literal_error", "enum"}:
            options = [option.strip(" '") for option in error["ctx"]["expected"].replace(" or ", ",").split(",")]
            hint = did_you_mean(str(node.value), options)
            others = dict.fromkeys(_EXPECTED[e["type"]] for e in group if e["type"] in _EXPECTED)
            help_ = f"{hint} allowed: {', '.join((*options, *others))}".strip()
            if others and (meaning := self.meaning(path)):
                help_ += f"; {meaning}"
            shown = f'"{node.raw}"' if node.kind == "scalar" else _shown(node)
            return Diagnostic("PG107", f'{shown} is not a value of "{self.key(path)}"', node.span, help=help_)
        code = "PG107" if error["type"].startswith(_RANGE_ERRORS) else "PG106"
        message = str(error["msg"]).removeprefix("Value error, ")
        message, counted, _ = f"{message[0].lower()}{message[1:]}".partition(" after validation")
        unit = " ms" if _TIME.fullmatch(str(node.value)) and message[-1].isdigit() else ""  # times are bounded in ms
        message = _SHOULD.sub(r"must \1", message) + unit + ("" if counted else f", not {_shown(node)}")
        return Diagnostic(code, f'"{self.key(path)}": {message}', node.span)

    def where(self, path: Path) -> str:
        return ".".join(map(str, path[:-1])) or self.what

    def key(self, path: Path) -> str:
        """Key that a value belongs to; pydantic names the alternatives of a union in the path, too."""
        path = self.written(path)
        return str(path[-1]) if path else "value"

    def written(self, path: Path) -> Path:
        """The part of a path that ends with a key of the file: short forms leave keys out."""
        while path and (isinstance(path[-1], int) or str(path[-1]) not in self.root.find(path[:-1]).pairs):
            path = path[:-1]
        return path

    def meaning(self, path: Path) -> str:
        """What the key means whose value is wrong, and the keys that may stand below it."""
        path = self.written(path)
        described = description_at(self.model, path)
        keys = ", ".join(self.keys(path))
        return "; ".join([f"{path[-1]}: {described}"] * bool(described) + [f"keys here: {keys}"] * bool(keys))

    def unknown_key(self, path: Path) -> Diagnostic:
        name = str(path[-1])
        allowed = self.keys(path[:-1])
        models = (part for part in _at(self.model, path[:-1]) if _is_model(part) and issubclass(part, StrictModel))
        meant = next((f"{text};" for part in models if (text := part.FOREIGN.get(name.lower()))), "")
        hint = meant or self.lower(name, allowed) or did_you_mean(name, allowed) or "remove the key;"
        help_ = f"{hint} keys here: {', '.join(allowed)}" if allowed else hint.rstrip(";")
        place = self.root.find(path[:-1]).key_span(name)
        return Diagnostic("PG104", f'unknown key "{name}" in {self.where(path)}', place, help=help_)

    def lower(self, name: str, allowed: Iterable[str]) -> str:
        """What to write if only the letter case is wrong."""
        return (
            f"write {name.lower()}: keys are in lower case;" if name.lower() in allowed and name.lower() != name else ""
        )

    def custom(self, path: Path, words: Mapping[str, Any]) -> Diagnostic:
        of_key = path[-1:] == ("[key]",)
        path = path[:-1] if of_key else path
        node = self.root.find(path)
        span = self.root.find(path[:-1]).key_span(str(path[-1])) if path and (of_key or words["key"]) else node.span
        return Diagnostic(words["code"], words["message"], span, help=words["help"])


def _shown(node: YamlNode) -> str:
    if node.kind == "map":
        return "a mapping"
    if node.kind == "seq":
        return "a list"
    if node.value is None:
        return "nothing"
    text = node.raw if len(node.raw) <= 40 else node.raw[:37] + "..."
    return f'"{text}"'

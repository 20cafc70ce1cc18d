"""From text to a model: keys that a message offers, several problems of one value, mistakes that hide no others."""

from __future__ import annotations

from typing import Annotated, Any

import pytest
from pydantic import AfterValidator, BaseModel, Field, RootModel, field_validator

from plcgen.base.diagnostics import DiagnosticError, Report
from plcgen.base.files.validation import (
    FileShape,
    Octets,
    Problems,
    StrictModel,
    keys_at,
    load_document,
    problem,
    read_document,
    unique,
    validate_option,
)


class Wheel(StrictModel):
    size: int = Field(ge=1)
    from_: str = Field("", alias="from")


def _word(text: str) -> str:
    if " " in text:
        raise problem(f'"{text}" has a blank', code="PG203", help_="write one word")
    return text


class Car(StrictModel):
    name: str
    wheels: Annotated[tuple[Wheel, ...], unique("size", "size {} appears twice")] = Field((), min_length=1)
    spare: Wheel | None = None
    colours: dict[Annotated[str, AfterValidator(_word)], int | Wheel] = Field(default_factory=dict)
    key: Octets = b""

    @field_validator("colours")
    @classmethod
    def _are_few(cls, colours: dict[str, Any]) -> dict[str, Any]:
        problems = Problems()
        for name in list(colours)[1:]:
            problems.add(problem(f"{name} is one too many", at_key=True), name)
        problems.raise_any()
        return colours


class Garage(RootModel[dict[str, Car]]):
    pass


CAR = FileShape(Car, "the car", "a car is a mapping", "see the manual")


def told(text: str, document: FileShape[Any] = CAR) -> list[tuple[str, int, int, str]]:
    """Everything wrong with a text."""
    with pytest.raises(DiagnosticError) as caught:
        load_document(text, "car.yaml", document)
    return [(d.code, d.span.line, d.span.column, d.message) for d in caught.value.diagnostics]


@pytest.mark.parametrize(
    ("model", "path", "keys"),
    [
        (Car, (), ["name", "wheels", "spare", "colours", "key"]),
        (Car, ("wheels", 3), ["size", "from"]),
        (Car, ("spare",), ["size", "from"]),
        (Car, ("colours", "red"), ["size", "from"]),
        (Car, ("name",), []),
        (Car, ("wheels",), []),
        (Car, ("wheels", "size"), []),
        (Car, ("nothing", "at", "all"), []),
        (Garage, ("mine", "wheels", 0), ["size", "from"]),
    ],
)
def test_keys_come_from_the_model(model: type[BaseModel], path: tuple[str | int, ...], keys: list[str]) -> None:
    """Through unions, lists, mappings and aliases."""
    assert keys_at(model, path) == keys


def test_a_valid_file_has_its_model_and_its_places() -> None:
    loaded = load_document("name: a\nwheels: [{size: 1}]\nkey: 01 FF\n", "car.yaml", CAR)
    assert (loaded.model.name, loaded.model.wheels, loaded.model.key) == ("a", (Wheel(size=1),), b"\x01\xff")
    assert loaded.root.find(("wheels", 0, "size")).span.column == 17


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", [("PG101", 1, 1, "the file is empty")]),
        ("- 1", [("PG106", 1, 1, "a car is a mapping")]),
        ("nam: a", [("PG104", 1, 1, 'unknown key "nam" in the car'), ("PG105", 1, 1, 'the car lacks the key "name"')]),
        ("name: yes", [("PG108", 1, 7, "ambiguous value yes: YAML 1.1 reads it as a truth value, YAML 1.2 as text")]),
        (
            "name: 1\nname: 2",
            [("PG106", 1, 7, 'expected text instead of "1"'), ("PG103", 2, 1, 'key "name" appears twice')],
        ),
        ("name: a\nwheels: []", [("PG107", 2, 9, '"wheels": must have at least 1 item')]),
        ("name: a\nwheels: [{size: 0}]", [("PG107", 2, 17, '"size": must be greater than or equal to 1, not "0"')]),
        (
            "name: a\nwheels: [{size: 5}, {size: x}, {size: 5}]",
            [("PG106", 2, 28, 'expected a whole number instead of "x"'), ("PG107", 2, 39, "size 5 appears twice")],
        ),
        ("name: a\ncolours: {a b: 1}", [("PG203", 2, 11, '"a b" has a blank')]),
        (
            "name: a\ncolours: {a: 1, b: 2, c: 3}",
            [("PG107", 2, 17, "b is one too many"), ("PG107", 2, 23, "c is one too many")],
        ),
        ("name: a\ncolours: {a: x}", [("PG106", 2, 14, 'expected a whole number or a mapping instead of "x"')]),
        ("name: a\nkey: 0", [("PG106", 2, 6, 'expected hexadecimal text in quotes instead of "0"')]),
        ("name: a\nkey: 0g", [("PG107", 2, 6, "bytes are hexadecimal text")]),
    ],
)  # fmt: skip
def test_mistakes(text: str, expected: list[tuple[str, int, int, str]]) -> None:
    """Each is told once, at its place; no mistake hides another."""
    assert told(text) == expected


def test_an_option_is_the_place_of_its_mistakes() -> None:
    """There is no line in a command line, so the option is quoted; the code is that of wrong use."""
    with pytest.raises(DiagnosticError) as caught:
        validate_option({"name": 1, "speed": 2}, "--car 1", CAR)
    assert [(d.code, str(d.span), d.message) for d in caught.value.diagnostics] == [
        ("PG901", "--car 1", 'unknown key "speed" in the car'),
        ("PG901", "--car 1", 'expected text instead of "1"'),
    ]


def test_a_report_goes_on() -> None:
    """A reader that collects is told None instead of a model."""
    report = Report()
    assert read_document("name: 1", "car.yaml", CAR, report) is None
    assert len(report) == 1

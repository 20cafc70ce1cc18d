"""The vectors of tests/vectors/ds47.yaml as objects."""

from functools import cache
from pathlib import Path
from typing import Any

from plcgen.ds47.wire.model import ErrorBlock, ParameterAddress, Request, Response, ValueBlock, ZeroBlock
from tests.yaml_files import read_yaml

PATH = Path(__file__).parents[1] / "vectors" / "ds47.yaml"


@cache
def tables() -> dict[str, Any]:
    """Return the file as plain data."""
    return read_yaml(PATH.read_text(encoding="utf-8"))


def _values(row: list) -> ValueBlock:
    return ValueBlock(row[0], row[1], bytes.fromhex(row[2]))


def _block(row: Any) -> ValueBlock | ErrorBlock | ZeroBlock:
    if row == "zero":
        return ZeroBlock()
    if isinstance(row, dict):
        return ErrorBlock(row["error"], row.get("info"))
    return _values(row)


def request(row: dict[str, Any]) -> Request:
    """Return the request of a row."""
    reference, identifier, drive_object = row["header"]
    addresses = tuple(ParameterAddress(pnu, sub, n, attribute) for attribute, n, pnu, sub in row["addresses"])
    values = tuple(_values(item) for item in row.get("values", ()))
    return Request(reference, identifier, drive_object, addresses, values)


def response(row: dict[str, Any]) -> Response:
    """Return the response of a row."""
    return Response(*row["header"], tuple(_block(item) for item in row["blocks"]))


REQUESTS = {row["id"]: row for row in tables()["requests"]}
RESPONSES = {row["id"]: row for row in tables()["responses"]}


def octets(row: dict[str, Any]) -> bytes:
    """Return the bytes of a row."""
    return bytes.fromhex(row["hex"])

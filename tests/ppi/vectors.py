"""The vectors of tests/vectors/ppi.yaml as objects."""

from functools import cache
from pathlib import Path
from typing import Any

from plcgen.ppi.wire import model
from tests.yaml_files import read_yaml

PATH = Path(__file__).parents[1] / "vectors" / "ppi.yaml"


@cache
def tables() -> dict[str, Any]:
    """Return the file as plain data."""
    return read_yaml(PATH.read_text(encoding="utf-8"))


FRAMES = {row["id"]: row for row in tables()["frames"]}
WRONG = {row["id"]: row for row in tables()["wrong"]}


def octets(row: dict[str, Any]) -> bytes:
    """Return the bytes of a row."""
    return bytes.fromhex(row["hex"])


def item(row: list[int]) -> model.Item:
    """Return an item: [area, transport size, count, data block, address]."""
    area, size, count, db, address = row
    return model.Item(area, size, count, address, db)


def pdu(row: dict[str, Any]) -> model.Pdu | None:
    """Return the PDU of a row; all seed frames have the reference 0."""
    meaning = row.get("pdu")
    if meaning is None:
        return None
    if isinstance(meaning, str):
        return model.RunRequest(0) if meaning == "run" else model.StopRequest(0)
    ((kind, value),) = meaning.items()
    if kind == "read":
        return model.ReadRequest(0, tuple(item(entry) for entry in value))
    if kind == "write":
        entries = tuple(model.ItemWrite(item(place), bytes.fromhex(data)) for place, data in value)
        return model.WriteRequest(0, entries, row.get("trailing_pad", False))
    if kind == "read_reply":
        results = tuple(model.ItemResult(code, bytes.fromhex(data), size) for code, size, data in value)
        return model.ReadReply(0, results)
    if kind == "write_reply":
        return model.WriteReply(0, tuple(value))
    if kind == "ack":
        return model.AckReply(0, value)
    place, data = value
    return model.ForceRequest(0, item(place), None if data is None else bytes.fromhex(data))


def frame(row: dict[str, Any]) -> model.Frame:
    """Return the frame of a row."""
    meaning = row["frame"]
    if meaning == "acknowledgement":
        return model.Acknowledgement()
    if "fixed" in meaning:
        return model.FixedFrame(*meaning["fixed"])
    return model.VariableFrame(*meaning["variable"], octets(row)[7:-2])

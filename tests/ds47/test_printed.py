"""Plants of printed manuals: the block sends what the manual prints and understands the answer that it prints."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from plcgen import api
from plcgen.ds47.plan.nouns import DrivePlan
from plcgen.ds47.wire.dissect import dissect_request, dissect_response, looks_like
from plcgen.project.opening import open_spec
from plcgen.s7.cpu.cpu import Cpu
from plcgen.s7.cpu.sources import load_folder
from plcgen.s7.cpu.system.port import Periphery
from plcgen.s7.scl.dialect import Dialect
from tests.yaml_files import read_yaml

PLANTS: dict[str, dict[str, Any]] = {
    plant["id"]: plant
    for plant in read_yaml((Path(__file__).parents[1] / "vectors" / "plants.yaml").read_text("utf-8"))
}
ROWS = [(plant, row) for plant in PLANTS.values() for row in plant["telegrams"]]
ADDRESS = 271


def every(rows: list[tuple[dict[str, Any], dict[str, Any]]]) -> pytest.MarkDecorator:
    """A test of each telegram, named after its device and page."""
    return pytest.mark.parametrize(("plant", "row"), rows, ids=[f"{one['id']}-{row['page']}" for one, row in rows])


class Printed:
    """A device that answers with the printed response, the reference mirrored."""

    def __init__(self, response: bytes) -> None:
        self.response, self.requests = response, list[bytes]()

    def write_record(self, _index: int, data: bytes) -> int:
        """Take any request."""
        self.requests.append(data)
        return 0

    def read_record(self, _index: int, _max_length: int) -> tuple[int, bytes]:
        """Return what is printed."""
        return 0, self.requests[-1][:1] + self.response

    def advance(self, milliseconds: int) -> None:
        """It answers at once."""


def behind_reference(printed: str) -> bytes:
    """Printed bytes but for the reference, which the channel counts."""
    return bytes.fromhex(printed[2:])


def spec(folder: Path, plant: dict[str, Any], job: dict[str, Any]) -> Path:
    """The job of a telegram with the drive of its manual."""
    device = plant.get("device")
    if device is None:
        profile = PLANTS[plant.get("like", plant["id"])]["profile"]
        head = {"title": plant["id"], "source": plant["manual"]}
        (folder / "device.yaml").write_text(yaml.safe_dump(head | profile))
        device = "./device.yaml"
    drive = {"device": device, "hardware_id": ADDRESS}
    if "drive_object" in plant:
        drive["drive_object"] = plant["drive_object"]
    content = {
        "plc": {"name": "Plant", "family": "s7-1500", "toolchain": "tia-v19"},
        "drives": {"drive": drive},
        "jobs": {"job": {"drive": "drive", **job}},
    }
    file = folder / "job.yaml"
    file.write_text(yaml.safe_dump(content))
    return file


@every(ROWS)
def test_what_is_sent(plant: dict[str, Any], row: dict[str, Any], tmp_path: Path) -> None:
    plan = open_spec(spec(tmp_path, plant, row["job"])).sound().plan(DrivePlan)
    assert plan is not None
    (telegram,) = plan.jobs[0].telegrams
    assert telegram.request.data[1:].hex(" ") == behind_reference(row["request"]).hex(" ")


@pytest.mark.slow
@every([one for one in ROWS if "response" in one[1]])
def test_what_is_made_of_the_answer(plant: dict[str, Any], row: dict[str, Any], tmp_path: Path) -> None:
    """The generated program sends the printed request, and its outputs have the values that the manual states."""
    assert api.generate(spec(tmp_path, plant, row["job"]), tmp_path / "out").ok
    device = Printed(behind_reference(row["response"]))
    cpu = Cpu(load_folder(tmp_path / "out", Dialect.TIA_1200_1500), Periphery(), family="s7-1500")
    cpu.bus.attach(ADDRESS, device)
    cpu.scan(10, 2)
    cpu["DriveJobs.job.execute"] = True
    cpu.scan(10, 100)
    assert [one[1:].hex(" ") for one in device.requests] == [behind_reference(row["request"]).hex(" ")]
    errors = row.get("errors", [])
    assert (cpu["DriveJobs.job.done"], cpu["DriveJobs.job.error"]) == (not errors, bool(errors))
    assert {name: cpu[f"DriveJobs.job.{name}"] for name in row.get("values", {})} == row.get("values", {})
    assert [cpu[f"DriveJobs.job.diagnosis.errors[{n}]"] for n, _ in enumerate(errors, 1)] == errors


@every(ROWS)
def test_decode_knows_them(plant: dict[str, Any], row: dict[str, Any]) -> None:
    """Every byte of the print has its field, none is marked."""
    request, response = (row.get(way, "XX").replace("XX", "01") for way in ("request", "response"))
    fields = dissect_request(bytes.fromhex(request))
    if "response" in row:
        assert looks_like(bytes.fromhex(response)) == "response"
        fields += dissect_response(bytes.fromhex(response))
    assert looks_like(bytes.fromhex(request)) == "request"
    assert [(plant["id"], field) for field in fields if field.problem] == []

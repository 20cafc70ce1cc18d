"""Specs the tests share: the shipped ones, and one that uses every data type."""

from __future__ import annotations

import atexit
import shutil
import tempfile
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SPECS = sorted((ROOT / "specs").glob("*.yaml"))
FAQ = ROOT / "specs" / "s7-300_6ra80_dp_tia.yaml"
MM4 = ROOT / "specs" / "s7-300_mm440_dp.yaml"

TARGETS = {
    "v5": ("s7-300", "step7-v5"),
    "t3": ("s7-400", "tia-v16"),
    "t15": ("s7-1500", "tia-v21"),
    "t12": ("s7-1200", "tia-v17"),
    "old": ("s7-1500", "tia-v13sp1"),
}


@cache
def generated_example(name: str) -> Path:
    """The files of a shipped spec, generated once per process; examples/ holds most of them as hashes only."""
    from plcgen import api

    folder = Path(tempfile.mkdtemp(prefix="plcgen-example-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    assert api.generate(ROOT / "specs" / f"{name}.yaml", folder / name).ok
    return folder / name


def per_block(text: str) -> str:
    """A spec whose blocks are a file each."""
    assert "plc: {" in text
    return text if "sources: per_block" in text else text.replace("plc: {", "plc: {sources: per_block, ", 1)


@cache
def per_block_spec(name: str) -> Path:
    """A shipped spec whose blocks are a file each; its files are in ``out`` beside it."""
    from plcgen import api

    folder = Path(tempfile.mkdtemp(prefix="plcgen-blocks-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    spec = folder / f"{name}.yaml"
    spec.write_text(per_block((ROOT / "specs" / f"{name}.yaml").read_text("utf-8")), "utf-8")
    assert api.generate(spec, folder / "out").ok
    return spec


EVERY_TYPE = """
plc: {{name: Every type, family: {family}, toolchain: {toolchain}, languages: [en-US, de-DE]}}
drives:
  axis:
    device: sinamics-s120
    address: 256
    hardware_id: 270
    drive_object: 3
    object_type: other
    parameters:
      P2890: {{type: Boolean, name: release}}
      P2901: {{type: Integer8, array: 9}}
      P2902: {{type: Unsigned8, array: 9}}
      P2903: {{type: Float64}}
      P2904: {{type: Integer64, array: 3}}
      P2905: {{type: Unsigned64}}
      P2906: {{type: "VisibleString[5]"}}
      P2907: {{type: "OctetString[3]"}}
      P2908: {{type: BinaryDate}}
      P2909: {{type: TimeOfDay, array: 2}}
      P2910: {{type: TimeDifference}}
      P2911: {{type: N2}}
      P2912: {{type: C4}}
      P2913: {{type: V2}}
      P2914: {{type: T4}}
      P3000: {{type: FloatingPoint, array: 200, name: table}}
      P3001: {{type: Integer32, array: 2}}
      P3002: {{type: Unsigned32, bico: true}}
      P3003: {{type: Unsigned16, min: 5, max: 10}}
      P3004: {{type: Boolean, array: 3}}
jobs:
  read_all:
    drive: axis
    read: [P2890, "P2901[1..3]", "P2902[0..2]", P2903, "P2904[0..2]", P2905, P2906, P2907, P2908, "P2909[0..1]",
           P2910, P2911, P2912, P2913, P2914, "P3001[0..1]", P3002, P3003, "P3004[0..2]"]
  write_all:
    drive: axis
    write: {{P2890: null, "P2901[1..3]": null, "P2902[0..2]": [1, 2, 255], P2903: 1.5, "P2904[0..2]": null, P2905: 7,
            P2906: hello, P2907: "010203", P2908: null, "P2909[0..1]": null, P2910: 1000, P2911: -1, P2912: null,
            P2913: 16#8001, P2914: null, "P3001[0..1]": [-1, 1], P3002: r0722.3, P3003: null, "P3004[0..2]": null}}
    allow: {{P2909: a type, P2910: a type, P2911: a type, P2912: a type, P2913: a type}}
  read_table: {{drive: axis, read: ["P3000[0..199]", P3003], timeout: 60s}}
  write_table: {{drive: axis, write: {{"P3000[10..150]": null, P3003: 7}}, timeout: 60s}}
"""


def every_type(target: str) -> str:
    """The spec with every data type for one of ``TARGETS``."""
    family, toolchain = TARGETS[target]
    return EVERY_TYPE.format(family=family, toolchain=toolchain)


def retargeted(path: Path, target: str) -> str:
    """A shipped spec for another target: addresses of both kinds are added to every drive."""
    import re

    family, toolchain = TARGETS[target]
    text = re.sub(r"family: [\w-]+", f"family: {family}", path.read_text(encoding="utf-8"))
    text = re.sub(r"toolchain: [\w.-]+", f"toolchain: {toolchain}", text)
    text = re.sub(r"address: 256", "address: 256, hardware_id: 270", text)
    return re.sub(r"\n(\s+)hardware_id: (\d+)", r"\n\1address: \2\n\1hardware_id: \2", text)

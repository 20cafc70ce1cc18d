"""Reviews that the tests of this folder share."""

from __future__ import annotations

import subprocess
from functools import cache
from pathlib import Path

from plcgen import api
from plcgen.base.display.view import PLAIN
from plcgen.report.registry import output_format
from plcgen.report.review.model import Review
from tests.projects import FAQ, ROOT, generated_example

LONG = "veryLongMemberNameOfAnEngineerWhoLikesIt"
HOSTILE = f"""
plc: {{name: "Line <b>1</b> & 'two'", family: s7-1500, toolchain: tia-v19}}
drives:
  axis_of_the_conveyor_in_front_of_the_oven:
    device: sinamics-s120
    hardware_id: 270
    drive_object: 3
    comment: "<script>alert(1)</script>"
    parameters:
      P2890: {{type: FloatingPoint, name: long_one, title: "<img src=x onerror=alert(2)> | *marks*", unit: "</td>"}}
      P2901: {{type: Unsigned16, array: 20}}
jobs:
  write_it_all:
    drive: axis_of_the_conveyor_in_front_of_the_oven
    comment: "]]> --> </script> &amp;"
    write:
      - {{parameter: P2890, as: {LONG}}}
      - {{parameter: "P2901[0..19]"}}
  read_it_all:
    drive: axis_of_the_conveyor_in_front_of_the_oven
    read: [P2890, "P2901[0..9]"]
"""


@cache
def faq_review() -> Review:
    """The FAQ's example without the matrix of faults."""
    return api.review(FAQ, generated_example(FAQ.stem), faults="none")


@cache
def ppi_review() -> Review:
    """The example with a CP 341 without the matrix of faults."""
    spec = ROOT / "specs" / "s7-300_s7-200_ppi_cp341.yaml"
    return api.review(spec, generated_example(spec.stem), faults="none")


def hostile_review(room: Path) -> Review:
    """A spec whose texts are markup, with names that fit nowhere."""
    spec = room / "hostile.yaml"
    spec.write_text(HOSTILE, "utf-8")
    made = api.generate(spec, room / "out")
    assert made.ok, made.diagnostics
    return api.review(spec, room / "out", faults="none")


def show(name: str, review: Review) -> str:
    """A review in a format."""
    format_ = output_format(name)
    assert format_ is not None
    return format_.render("review", review, PLAIN)


def git(room: Path, *arguments: str) -> str:
    """Git in a folder, with a name and no settings of the machine."""
    who = ["-c", "user.name=Test", "-c", "user.email=test@example.org", "-c", "init.defaultBranch=main"]
    done = subprocess.run(["git", "-C", str(room), *who, *arguments], capture_output=True, check=True)
    return done.stdout.decode()

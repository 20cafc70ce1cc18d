"""YAML of the tests, read by libyaml: case files are read while tests are collected, in every process."""

from __future__ import annotations

from typing import Any

import yaml

_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_yaml(text: str) -> Any:
    """What the text says."""
    return yaml.load(text, _LOADER)  # noqa: S506 - it is a safe one

"""The shape of a whole spec: what every spec has, with the sections of the protocols that it uses."""

from __future__ import annotations

import functools
from typing import Any

from pydantic import create_model

from plcgen.project.editor import in_a_file
from plcgen.project.schema import Spec
from plcgen.protocols.base import Protocol

VERSION = 1
"""Version of the spec format, the only one that ``version:`` may say."""


@functools.cache
def spec_model(used: tuple[Protocol, ...]) -> type[Spec]:
    """The shape of a spec that uses these protocols."""
    sections = tuple(protocol.section(alone=len(used) == 1) for protocol in used)
    return create_model("Spec", __base__=(Spec, *sections), __doc__=Spec.__doc__)  # type: ignore[arg-type]


def json_schema(known: tuple[Protocol, ...]) -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a job spec for editors, short forms included."""
    from plcgen.project.cpus import cpu_names

    schema = spec_model(known).model_json_schema(by_alias=True)
    schema["$defs"]["Plc"]["properties"]["cpu"]["anyOf"].insert(0, {"enum": list(cpu_names())})
    for protocol in known:
        protocol.complete(schema)
    schema["required"] = ["plc"]
    schema["anyOf"] = [
        {"required": [name], "properties": {name: {"minProperties": 1}}}
        for name in (protocol.sections[0] for protocol in known)
    ]
    schema["description"] = "A PLC, its drives and stations, and the jobs that read and write their values."
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": f"urn:plcgen:spec:{VERSION}"}
    return {**head, "title": "plcgen job spec", **in_a_file(schema)}

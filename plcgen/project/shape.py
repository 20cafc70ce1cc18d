"""The shape of a whole spec: what every spec has, with the sections of the protocols that it uses."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import Any

from pydantic import create_model

from plcgen.base.plugins import expect_free
from plcgen.project.editor import Requirements, in_a_file, with_variables
from plcgen.project.includes import WHOLE
from plcgen.project.part import SpecPart
from plcgen.project.registry import GROUP
from plcgen.project.schema import Spec

VERSION = 1
"""Version of the spec format, the only one that ``version:`` may say."""


@functools.cache
def spec_model(used: tuple[SpecPart, ...]) -> type[Spec]:
    """The shape of a spec that uses these protocols. Raises PluginError if one has a key that every spec has."""
    expect_free(GROUP, (section for protocol in used for section in protocol.sections), Spec.model_fields)
    sections = tuple(protocol.section(alone=len(used) == 1) for protocol in used)
    return create_model("Spec", __base__=(Spec, *sections), __doc__=Spec.__doc__)  # type: ignore[arg-type]


def json_schema(known: tuple[SpecPart, ...], profiles: Sequence[str] = (), *, shared: bool = False) -> dict[str, Any]:
    """JSON schema (draft 2020-12) of a job spec for editors, short forms included; ``shared``: of an included file.

    It offers what ``profiles`` of the user's own name, too. Raises DiagnosticError if one of these files is none.
    """
    from plcgen.project.cpus import cpu_names

    schema = spec_model(known).model_json_schema(by_alias=True)
    schema["$defs"]["Plc"]["properties"]["cpu"]["anyOf"].insert(0, {"enum": list(cpu_names())})
    for protocol in known:
        protocol.complete(schema, profiles)
    del schema["required"]
    definitions = schema.pop("$defs")
    whole = {"required": ["plc"], **Requirements(definitions, WHOLE).take(schema)}
    whole["anyOf"] = [
        {"required": [name], "properties": {name: {"minProperties": 1}}}
        for name in (protocol.sections[0] for protocol in known)
    ]
    if not shared:
        schema |= {"if": {"not": {"required": ["include"]}}, "then": whole}
    kind, text = ("shared", "Part of a spec, for files that specs include.") if shared else ("spec", _TEXT)
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": f"urn:plcgen:{kind}:{VERSION}"}
    title = "plcgen shared file" if shared else "plcgen job spec"
    spelled = in_a_file({**schema, "$defs": definitions})
    spelled["$defs"] = with_variables(spelled["$defs"])
    return {**head, "title": title, **spelled, "description": text}


_TEXT = "A PLC, its drives and stations, and the jobs that read and write their values."

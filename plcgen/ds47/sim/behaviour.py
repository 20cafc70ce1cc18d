"""What differs from device to device in serving data set 47."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from plcgen.ds47.wire.model import MAX_ELEMENTS, MAX_PARAMETERS, RECORD_LIMIT, Attribute

if TYPE_CHECKING:
    from collections.abc import Mapping

    from plcgen.ds47.wire.errors import Table
    from plcgen.ds47.wire.formats import Takes

PROFIBUS_INDEX, LOCAL_INDEX, GLOBAL_INDEX = 47, 0xB02E, 0xB02F


@dataclass(frozen=True, slots=True)
class Behaviour:
    """Behaviour of a device.

    error_words: 1 or 2 words per error block; SINAMICS sends 2.
    answer_format: ``exact`` answers the profile type, ``size`` 41h to 43h where one fits (MM4).
    takes: in which formats a change may come; any other is answered with 05h.
    record_indexes: data records that carry DS47: 47, B02Eh (local), B02Fh (global).
    aliases: further drive object numbers and the object each one means (MM4: 1 means 0).
    local_object: the object that record B02Eh addresses whatever the drive object byte says.
    strict_length: a request that is not exactly as long as its contents answers 18h and writes nothing.
    processing: milliseconds from WRREC until the response is available.
    """

    error_words: Literal[1, 2] = 2
    answer_format: Literal["exact", "size"] = "exact"
    takes: Takes = "any"
    record_indexes: tuple[int, ...] = (PROFIBUS_INDEX, GLOBAL_INDEX)
    aliases: Mapping[int, int] = field(default_factory=dict)
    local_object: int | None = None
    max_parameters: int = MAX_PARAMETERS
    max_elements: int = MAX_ELEMENTS
    record_limit: int = RECORD_LIMIT
    multi_supported: bool = True
    attributes: frozenset[int] = frozenset({int(Attribute.VALUE)})
    strict_length: bool = True
    error_table: Table = "sinamics"
    processing: int = 0

"""What is wrong with planned parameter jobs: one function per code and subject."""

from __future__ import annotations

from plcgen.ds47.rules import drives, inputs, members, names, objects, parameters, readback, saves, telegrams
from plcgen.project.part import Rules

RULES = Rules(
    checks=(
        drives.drive_object,
        drives.without_clock,
        drives.unused_address,
        drives.divided_device,
        drives.shared_address,
        drives.separate_objects,
        drives.engine_places,
        objects.no_types,
        objects.missing,
        parameters.definitions,
        parameters.access,
        parameters.repeated,
        parameters.dangerous,
        parameters.unclassified,
        parameters.only_bytes,
        inputs.unconnected,
        parameters.unknown_types,
        telegrams.response_buffer,
        telegrams.request_buffer,
        telegrams.reference,
        telegrams.timing,
        telegrams.repeated,
        saves.counted_apart,
        saves.short_wait,
        readback.readable,
        readback.nothing_written,
        readback.not_restored,
        members.control_members,
        members.parameter_names,
        members.interface_members,
        members.buffer_members,
        members.overrides,
    ),
    names=names.names,
    texts=names.texts,
    untranslated=names.untranslated,
    taken=names.taken,
    partners=names.partners,
    remarks=(inputs.left_open, parameters.untyped, drives.no_records_of_a_processor),
)

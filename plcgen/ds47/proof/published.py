"""Published telegrams, byte for byte, for the forms that a project uses: which manual stands behind which form.

A form is a service with a type of value. The codec must make the telegram of the manual from what the manual says that
it means, and read that meaning from its bytes.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

from plcgen.base.diagnostics import Diagnostic, Span
from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.nouns import DriveJob, DrivePlan
from plcgen.ds47.wire import codec, formats
from plcgen.ds47.wire.bico import SELF, BicoSource, read_bico
from plcgen.ds47.wire.model import ErrorBlock, ParameterAddress, Request, RequestId, Response, ValueBlock
from plcgen.oracles.documents import PublishedTelegram, codes_alike, published, published_sources
from plcgen.proof.checks import Check, Outcome

_BUG = "this is a bug of this copy of plcgen: please report it"


@dataclass(frozen=True, slots=True)
class Form:
    """A service with a type of value; ``by_size``: answered as byte, word or double word."""

    writes: bool
    type: str
    by_size: bool
    source: str

    @classmethod
    def of(cls, job: DriveJob, use: Use) -> Form:
        """The form of one use; a change is answered without values."""
        by_size = not use.writes and job.drive.device.answer_format == "size"
        return cls(use.writes, use.format.name, by_size, use.format.source)

    def __str__(self) -> str:
        by_size = ", answered by size" if self.by_size else ""
        return f"{'write' if self.writes else 'read'} {self.type}{by_size}"

    def telegrams(self) -> list[PublishedTelegram]:
        """Published telegrams that have the form."""
        return [
            one
            for one in published()
            if one.writes == self.writes
            and (self.writes or one.by_size == self.by_size)
            and any(parameter.type == self.type for parameter in one.parameters)
        ]


def published_checks(plan: DrivePlan) -> Iterator[Check]:
    """One check for each form of the project."""
    for form in dict.fromkeys(Form.of(job, use) for job in plan.shapes for use in job.uses):
        known = form.telegrams()
        id_ = f"published.{'write' if form.writes else 'read'}.{form.type}"
        if not known:
            verdict = f"not run: no published telegram; the format is from: {form.source}"
            yield Check(id_, str(form), "", Outcome.NOT_RUN, verdict)
            continue
        wrong = next((found for one in known if (found := disagreement(one))), "")
        text = "; ".join(one.source for one in known)
        if wrong:
            problem = Diagnostic("PG640", wrong, Span(""), help=_BUG)
            yield Check(id_, str(form), text, Outcome.ERROR, wrong, problem)
        else:
            yield Check(id_, str(form), text, Outcome.OK, "byte for byte as published")
    for codes, source in codes_alike():
        if any(use.format.code in codes and not use.writes for job in plan.shapes for use in job.uses):
            yield _alike_check(codes, source)
    if any(use.sources for job in plan.shapes for use in job.uses):
        yield _source_check()


def _alike_check(codes: frozenset[int], source: str) -> Check:
    """A value is read the same in each of the codes of its type."""
    names = " and ".join(formats.by_code(code).name for code in sorted(codes))
    for declared, came in itertools.permutations(map(formats.by_code, codes), 2):
        if came.code not in formats.answers(declared):
            message = f"{declared.name} answered as {came.code:02X}h is refused here, but not in: {source}"
            problem = Diagnostic("PG640", message, Span(""), help=_BUG)
            return Check("published.alike", names, source, Outcome.ERROR, message, problem)
    return Check("published.alike", names, source, Outcome.OK, "either code is taken")


def _source_check() -> Check:
    """Values of sources (BICO) as manuals print them."""
    text = "; ".join(dict.fromkeys(one.source for one in published_sources()))
    for one in published_sources():
        made = BicoSource(one.number, one.index, SELF if one.drive_object is None else one.drive_object)
        if made.value != one.value or read_bico(one.value) != made:
            message = f"{made} is {made.value:08X}h here, {one.value:08X}h in: {one.source}"
            problem = Diagnostic("PG640", message, Span(""), help=_BUG)
            return Check("published.source", "sources (BICO)", text, Outcome.ERROR, message, problem)
    return Check("published.source", "sources (BICO)", text, Outcome.OK, "as published")


def disagreement(one: PublishedTelegram) -> str:
    """How the codec and a published telegram differ; empty if they do not."""
    try:
        return _disagreement(one)
    except (codec.TelegramError, formats.FormatValueError, KeyError) as problem:
        return f"{one.source}: {problem}"


def _disagreement(one: PublishedTelegram) -> str:
    types = [formats.by_name(parameter.type) for parameter in one.parameters]
    values = [ValueBlock.of(fmt, parameter.values) for fmt, parameter in zip(types, one.parameters, strict=True)]
    addresses = tuple(ParameterAddress(said.number, said.subindex, said.elements) for said in one.parameters)
    identifier = RequestId.CHANGE if one.writes else RequestId.READ
    reference, count = one.request[0], len(addresses)
    request = Request(reference, identifier, one.drive_object, addresses, tuple(values) if one.writes else ())
    if not one.writes and one.by_size:
        values = [ValueBlock(_by_size(block, len(block.data)), block.count, block.data) for block in values]
    answer = Response(reference, identifier, one.drive_object, count, () if one.writes else tuple(values))
    for what, made, printed in (
        ("request", codec.encode_request(request), one.request),
        ("answer", codec.encode_response(answer), one.answer),
    ):
        if made != printed:
            return f"{one.source}: the {what} is {printed.hex(' ').upper()}, made here {made.hex(' ').upper()}"
    if codec.decode_request(one.request) != request:
        return f"{one.source}: the request is read as {codec.decode_request(one.request)}"
    read = codec.decode_response(one.answer, request=request)
    for block, fmt, said in zip(read.blocks, types, one.parameters, strict=False):
        if isinstance(block, ErrorBlock) or not isinstance(block, ValueBlock):
            return f"{one.source}: the answer is read as {read}"
        if tuple(block.values(fmt)) != said.values:
            return f"{one.source}: the values are read as {block.values(fmt)}"
    return ""


def _by_size(block: ValueBlock, size: int) -> int:
    generic = formats.generic_of(size // block.count)
    return generic.code if generic is not None else block.format

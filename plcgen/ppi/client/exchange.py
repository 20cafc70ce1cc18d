"""One request and its answer over a line: request, E5, poll, answer; bounded sends, polls and waiting.

A repetition keeps the frame count bit, so a station that has already executed the request only answers again. What
does not belong to the exchange is passed over: echoes of our own bytes, tokens, frames of other stations, garbage. An
answer with another reference is one to an older request: it is refused, and the poll goes on.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

from plcgen.base.diagnostics import Diagnostic, DiagnosticError, Span
from plcgen.base.line import Line
from plcgen.ppi.client.heard import Heard, HeardKind, KnownReplies
from plcgen.ppi.wire.areas import Area, Function
from plcgen.ppi.wire.codes import function_text, header_error
from plcgen.ppi.wire.errors import TOLERABLE
from plcgen.ppi.wire.fdl import encode_frame, found_frame, sd2
from plcgen.ppi.wire.model import (
    REQUEST,
    Acknowledgement,
    ErrorReply,
    FixedFrame,
    Frame,
    FrameCount,
    Item,
    Pdu,
    ReadReply,
    ReadRequest,
    Request,
    VariableFrame,
)
from plcgen.ppi.wire.pdu import encode_pdu, examine_pdu
from plcgen.ppi.wire.stream import Chunk, Splitter

NO_ANSWER, REFUSED = "PG718", "PG719"
_NO_DATA, _NO_RESOURCE = 0x09, 0x02
_FUNCTION, _ERROR, _ANSWERED = 10, 10, 12
"""Places of the function in the PDU of a job, of error and function in that of its answer; the number of items follows.
"""
_WITH_ITEMS = frozenset({int(Function.READ), int(Function.WRITE)})
_HARMLESS = frozenset({int(Function.READ), int(Function.SETUP)})
_FIRST_REFERENCE = 0xA55A
_FIRST = encode_pdu(ReadRequest(_FIRST_REFERENCE, (Item.memory(Area.SM, 0),)))
"""A read of SMB0: every S7-200 has it, and reading it changes nothing. No partner makes up its reference."""
_ADDRESSED = (VariableFrame, FixedFrame)
_FRESH = 0.005
"""Seconds behind a smooth exchange in which nothing can have arrived that is worth looking for."""

_LEFTOVERS = 64 * 1024
"""Most bytes of older traffic that are thrown away before a request; a line that never stops is not drained."""


class ClientError(DiagnosticError):
    """An exchange that failed: one diagnostic whose place is the line."""

    def __init__(self, code: str, line: str, message: str, help_: str = "") -> None:
        super().__init__([Diagnostic(code, message, Span(line), help=help_)])


class NoAnswerError(ClientError):
    """Silence, E5 without end, or nothing but garbage and answers to other requests."""

    def __init__(self, line: str, message: str, help_: str = "") -> None:
        super().__init__(NO_ANSWER, line, message, help_)


class RefusedError(ClientError):
    """The station refused the job as a whole; ``error`` is error class and code of its header, 0 without one."""

    def __init__(self, line: str, message: str, help_: str = "", error: int = 0) -> None:
        self.error = error
        super().__init__(REFUSED, line, message, help_)


@dataclass(frozen=True, slots=True)
class Settings:
    """Stations and bounds of an exchange; times in seconds.

    ``answer`` is the wait for the beginning of an answer, ``frame`` for the rest of a frame that has begun (255 bytes
    take 0.3 s at 9600 bit/s), ``pause`` lies between E5 and the next poll. ``reference``: whether an answer must have
    that of its request; what a partner does that never repeats it is found out by the first read.
    """

    station: int = 2
    own: int = 0
    sends: int = 3
    polls: int = 10
    answer: float = 0.4
    frame: float = 0.5
    pause: float = 0.02
    reference: Literal["check", "ignore"] = "check"


@dataclass(slots=True)
class Count:
    """What happened on the line, for people who look for its quality."""

    exchanges: int = 0
    sends: int = 0
    polls: int = 0
    repeats: int = 0
    skipped: int = 0


@dataclass(slots=True)
class _References:
    """What is known of a partner: ``ignored`` if the references of its answers mean nothing.

    Gateways and simulations answer with a reference of their own. A partner is one of them if it does so to the first
    harmless read, whose answer fits otherwise, and again when that is repeated with another reference; not if it has
    ``echoed`` one. ``strange`` is the reference of such an answer to the read that runs, ``before`` that of its first
    try. One request is under way at a time, so an answer can only be that to the request before or to this one.
    """

    ignored: bool = False
    echoed: bool = False
    strange: int | None = None
    before: int | None = None

    def begin(self) -> None:
        """Another request."""
        self.strange = self.before = None

    def fit(self, request: bytes, answer: bytes, reference: int) -> bool:
        """Whether an answer may be that to a request with this reference."""
        found = int.from_bytes(answer[4:6])
        if found == reference:
            self.echoed, self.strange = True, None
            return True
        length = 2 if request[_FUNCTION] in _WITH_ITEMS else 1
        asked, answered = request[_FUNCTION : _FUNCTION + length], answer[_ANSWERED : _ANSWERED + length]
        same = any(answer[_ERROR:_ANSWERED]) or asked == answered
        if not self.ignored and same and not self.echoed and request[_FUNCTION] in _HARMLESS:
            self.ignored = self.before not in {None, found}
            self.strange = None if self.ignored else found
        return self.ignored and same


class Exchange:
    """Exchanges with one station over one line; ``now`` tells the time in seconds."""

    def __init__(self, line: Line, settings: Settings | None = None, now: Callable[[], float] = time.monotonic) -> None:
        self.line = line
        self.settings = settings or Settings()
        self.count = Count()
        self._now = now
        self._frame_count = FrameCount()
        self._polls: dict[int, bytes] = {}
        self._clean_until = -math.inf
        self._frames: list[Frame] = []
        self._splitter = Splitter(tolerant=True)
        self._heard = Heard()
        self._known = KnownReplies()
        self._asked = False
        self.notice: Callable[[str], object] = lambda _text: None
        """Is told what the user should know of a session that works."""
        self._references = _References(ignored=self.settings.reference == "ignore")

    def run(self, request: Request) -> Pdu:
        """Return the answer to a request, see ``run_encoded``. Raises PpiError if the request makes no PDU."""
        return self.run_encoded(encode_pdu(request), request.reference)

    def run_encoded(self, pdu: bytes, reference: int) -> Pdu:
        """Return the answer to a request whose PDU has this reference.

        The very first frame, 6Ch, is the one of which a station cannot see a repetition: if its E5 is lost, it is
        executed twice. So what is more than a read comes second, behind a read of SMB0. A read that gets no answer is
        sent once more as a whole, unless it was refused: reading twice does no harm. Anything else is not repeated: it
        may have been executed, which the error says, also if nothing came: every E5 may have been lost.

        Raises NoAnswerError, RefusedError (an error in the header, or a negative answer of the line) and LineError.
        """
        harmless = pdu[_FUNCTION] in _HARMLESS
        if self._frame_count.last is None and not harmless:
            self._twice(_FIRST, _FIRST_REFERENCE)
        reply = self._twice(pdu, reference) if harmless else self._once(pdu, reference)
        if isinstance(reply, ErrorReply):
            meaning = header_error(reply.code)
            text = f"station {self.settings.station} refuses the job: {reply.code:04X}h, {meaning.text}"
            raise RefusedError(self.line.name, text, meaning.help, reply.code)
        return reply

    def _twice(self, pdu: bytes, reference: int) -> Pdu:
        """One exchange, and another one if the first had no answer, with another reference if it had a strange one."""
        known = self._references
        known.begin()
        try:
            return self._one(pdu, reference)
        except NoAnswerError:
            self.count.repeats += 1
        if known.strange is not None:
            known.before, reference = reference, reference ^ 0xFFFF
            pdu = pdu[:4] + reference.to_bytes(2) + pdu[6:]
        return self._one(pdu, reference)

    def _once(self, pdu: bytes, reference: int) -> Pdu:
        """One exchange of which nobody knows how it ended if nothing is heard: every E5 may be lost, too."""
        try:
            return self._one(pdu, reference)
        except NoAnswerError as problem:
            (found,) = problem.diagnostics
            text = f"{found.message}; the request{' was taken and' if self._asked else ''} may have been executed"
            help_ = "read what it should have changed before you repeat it"
            raise NoAnswerError(self.line.name, text, help_ if self._asked else f"{help_}; {found.help}") from problem

    def _one(self, pdu: bytes, reference: int) -> Pdu:
        count = self.count
        count.exchanges += 1
        if self._now() > self._clean_until:
            self._drain()
        odd = count.repeats + count.skipped
        self._heard, self._asked = Heard(), False
        try:
            reply = self._poll(pdu, reference, self._send(pdu))
        except ClientError:
            self._frame_count.restart()
            self._clean_until = -math.inf
            raise
        clean = odd == count.repeats + count.skipped and not self._frames and not self._splitter.pending
        self._clean_until = self._now() + _FRESH if clean else -math.inf
        return reply

    def _send(self, pdu: bytes) -> Frame:
        settings = self.settings
        function = self._frame_count.following()
        data = sd2(bytes((settings.station, settings.own, function)) + pdu)
        for attempt in range(settings.sends):
            self.count.sends += 1
            self.count.repeats += attempt > 0
            self.line.write(data)
            frame = self._receive()
            if frame is not None and not self._try_again(frame):
                return frame
        raise self._silent(f"{settings.sends} times sent")

    def _silent(self, tries: str) -> NoAnswerError:
        text, help_ = self._heard.text(self.settings.station, tries)
        return NoAnswerError(self.line.name, text, help_)

    def _try_again(self, frame: Frame) -> bool:
        """Whether a short answer asks for a repetition; one that refuses for good raises RefusedError."""
        if not isinstance(frame, FixedFrame):
            return False
        status = frame.function & 0x0F
        if status in {0x00, _NO_RESOURCE, _NO_DATA}:
            if status == _NO_RESOURCE:
                self._heard.outcomes.append(HeardKind.BUSY)
            return status == _NO_RESOURCE
        text = f"station {self.settings.station} refuses the telegram: {function_text(frame.function)}"
        raise RefusedError(self.line.name, text)

    def _poll(self, request: bytes, reference: int, frame: Frame | None) -> Pdu:
        """Poll until the answer to the request comes, a bounded number of times.

        E5 (not ready) is followed by a new poll with the other frame count bit, silence by the same poll again. After
        an answer to something else the right one may be on its way, so the line is listened to before that.
        """
        settings, heard = self.settings, self._heard
        listened = False
        heard.outcomes.clear()  # the station has answered: what counts is what it says to polls
        self._asked = True
        for number in range(settings.polls + 1):
            again = frame is None
            if isinstance(frame, VariableFrame):
                reply, heard.other = self._reply(request, reference, frame)
                if reply is not None:
                    return reply
                heard.outcomes.append(HeardKind.OTHER)
                listened = not listened
                frame = self._receive() if listened else frame
                if listened and frame is not None:
                    continue
                if self._references.strange is not None:
                    break
                again = listened
            elif frame is not None and number > 0:
                if not self._try_again(frame):
                    heard.outcomes.append(HeardKind.NOT_READY)
                self._wait(settings.pause)
            if number < settings.polls:
                frame = self._ask(again=again)
        raise self._silent(f"{number} polls")

    def _ask(self, *, again: bool) -> Frame | None:
        """Send a poll, or the last one once more, and return what comes back."""
        function = self._frame_count.last if again else None
        function = self._frame_count.following() if function is None else function
        self.count.polls += 1
        self.count.repeats += again
        self.line.write(self._poll_frame(function))
        return self._receive()

    def _poll_frame(self, function: int) -> bytes:
        found = self._polls.get(function)
        if found is None:
            frame = FixedFrame(self.settings.station, self.settings.own, function)
            found = self._polls.setdefault(function, encode_frame(frame))
        return found

    def _reply(self, request: bytes, reference: int, frame: VariableFrame) -> tuple[Pdu | None, str]:
        """Return the PDU if it is the answer to the request, otherwise why not."""
        layout = self._known.find(request)
        if layout is not None and (frame.pdu[4:6] == request[4:6] or self._references.ignored):
            known = layout.read(frame.pdu, reference)
            if known is not None:
                return known, ""
        pdu, found = examine_pdu(frame.pdu)
        if isinstance(pdu, ReadReply) and not found:
            self._known.keep(request, frame.pdu, pdu)
        wrong = [violation for violation in found if violation.kind not in TOLERABLE]
        if pdu is None or wrong:
            self.count.skipped += 1
            return None, f"an answer that is no valid PDU ({wrong[0].message if wrong else 'unknown'})"
        ignored = self._references.ignored
        if not self._references.fit(request, frame.pdu, reference):
            self.count.skipped += 1
            return None, f"an answer to request {pdu.reference:04X}h instead of {reference:04X}h"
        if self._references.ignored and not ignored:
            text = "does not repeat references: its answers are taken in their order"
            self.notice(f"station {self.settings.station} {text}")
        return pdu if pdu.reference == reference else replace(pdu, reference=reference), ""

    # ---- Frames -----------------------------------------------------------------------------------------------

    def _receive(self) -> Frame | None:
        """Return the next frame of the station; None if none comes in time."""
        settings, splitter = self.settings, self._splitter
        deadline = self._now() + settings.answer
        damaged = self._heard.damaged
        extended = False
        while True:
            while self._frames:
                frame = self._frames.pop(0)
                if self._is_ours(frame):
                    return frame
                self.count.skipped += 1
            if splitter.pending and not extended:
                deadline += settings.frame
                extended = True
            left = deadline - self._now()
            if left <= 0:
                rest = splitter.rest
                chunks = splitter.finish()
                self._take(chunks, last=True)
                if not self._frames:
                    garbage = any(not chunk.frame for chunk in chunks)
                    self._heard.nothing(damaged, rest, settings.own, settings.station, garbage=garbage)
                    return None
                continue
            data = self.line.read(timeout=left)
            if splitter.whole(data):
                frame = found_frame(data)
                if self._is_ours(frame):
                    return frame
                self.count.skipped += 1
            elif data:
                self._take(splitter.feed(data))

    def _take(self, chunks: list[Chunk], *, last: bool = False) -> None:
        """Keep frames and count the rest; what is left at the end is judged by itself."""
        for chunk in chunks:
            if chunk.frame:
                self._frames.append(found_frame(chunk.data))
            else:
                self.count.skipped += 1
                self._heard.damaged += not last

    def _is_ours(self, frame: Frame) -> bool:
        """Whether a frame can answer us: E5, or a frame from the station to us that is no request."""
        if isinstance(frame, _ADDRESSED):
            answers = frame.source == self.settings.station and frame.destination == self.settings.own
            return answers and not frame.function & REQUEST
        return isinstance(frame, Acknowledgement)

    def _wait(self, seconds: float) -> None:
        """Let time pass; what arrives meanwhile is kept."""
        end = self._now() + seconds
        while (left := end - self._now()) > 0:
            data = self.line.read(timeout=left)
            self._take(self._splitter.feed(data))

    def _drain(self) -> None:
        """Forget what arrived before the request: late answers and older traffic."""
        self._splitter.clear()
        self._frames.clear()
        taken = 0
        while taken < _LEFTOVERS:
            data = self.line.read(timeout=0)
            if not data:
                return
            taken += len(data)
            self.count.skipped += 1

"""What only a sequence of frames can show: the frame count bit that must alternate between requests.

EN 50170: a station that sees the same frame count bit again (FCV = 1) repeats its last answer and executes nothing. A
master that never toggles the bit gets old answers; some stations do not mind, hence tolerable.
"""

from __future__ import annotations

from plcgen.ppi.wire.errors import Kind, Violation
from plcgen.ppi.wire.model import FCB, FCV, REQUEST, FixedFrame, Frame, VariableFrame

_COUNTED = frozenset({0x3, 0x5, 0xC, 0xD})


class FrameCountCheck:
    """Follows the requests of a capture, each pair of stations on its own."""

    def __init__(self) -> None:
        self._last: dict[tuple[int, int], Frame] = {}

    def follow(self, frame: Frame) -> list[Violation]:
        """Take the next frame; return what is wrong with its function code (offset in the frame)."""
        if not isinstance(frame, VariableFrame | FixedFrame):
            return []
        function = frame.function
        if not function & REQUEST or function & 0x0F not in _COUNTED:
            return []
        pair = (frame.destination, frame.source)
        before = self._last.get(pair)
        self._last[pair] = frame
        if not function & FCV or not isinstance(before, VariableFrame | FixedFrame) or before == frame:
            return []
        if (before.function ^ function) & FCB:
            return []
        text = (
            f"the function code {function:02X}h has the frame count bit of the request before: "
            "a station repeats its last answer instead of executing this"
        )
        return [Violation(Kind.FRAME_COUNT, 6 if isinstance(frame, VariableFrame) else 3, text)]

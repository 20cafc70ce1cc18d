"""Parameters and drive objects of a simulated drive: values, limits, conditions, description, texts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from plcgen.ds47.wire import formats
from plcgen.ds47.wire.description import ARRAY, CHANGED, NO_SCALE, READ_ONLY, RESET_ONLY, TEXT_ARRAY, Description
from plcgen.ds47.wire.formats import Value

if TYPE_CHECKING:
    from collections.abc import Mapping

    from plcgen.ds47.wire.formats import Format

Keeps = Callable[[int, Value], Value]
"""What is kept of a value, from its index and itself."""


READY = "ready"
TEXT_SIZE = 16


@dataclass(frozen=True, slots=True)
class ValueLimits:
    """Smallest and largest value; None is no limit beyond the format's own."""

    low: float | None = None
    high: float | None = None

    def below(self, value: float) -> bool:
        """Whether the value is under the lower limit."""
        return self.low is not None and value < self.low

    def above(self, value: float) -> bool:
        """Whether the value is over the upper limit."""
        return self.high is not None and value > self.high


@dataclass(frozen=True, slots=True)
class Condition:
    """Refuses an access with ``error`` in the given states of the drive object, or in all other states.

    ``while_in`` ("running" with 11h or 6Bh) names states that refuse, ``unless_in`` ("quick_commissioning"
    with 70h) the only ones that allow. ``read`` refuses reads as well as changes.
    """

    error: int
    while_in: frozenset[str] = frozenset()
    unless_in: frozenset[str] = frozenset()
    read: bool = False

    def refuses(self, state: str) -> bool:
        """Whether an access is refused in this state."""
        return state in self.while_in or (bool(self.unless_in) and state not in self.unless_in)


@dataclass(slots=True)
class SimulatedParameter:
    """One parameter; ``values`` has one entry per array element, one for a string or a simple parameter.

    ``state_limits`` narrows the limits in a state (C8h, C9h). ``clears_after`` makes the value return to 0
    that many milliseconds after it was set, as p0971 and p0977 do; with ``saves`` ("object" or "unit") the
    values of the drive object or of the whole unit then survive ``Drive.power_cycle``. With ``acknowledges``
    the present faults then become those of the case before, but for the ``remaining`` first ones. ``keeps`` makes
    another value of a written one, from its index and itself: a drive that rounds, or clips without a word.
    """

    pnu: int
    format: Format
    values: list[Value]
    name: str = ""
    array: bool = False
    limits: ValueLimits = ValueLimits()
    state_limits: Mapping[str, ValueLimits] = field(default_factory=dict)
    read_only: bool = False
    reset_only: bool = False
    allowed: frozenset[Value] = frozenset()
    conditions: tuple[Condition, ...] = ()
    texts: tuple[str, ...] = ()
    described: bool = True
    clears_after: int | None = None
    saves: str = ""
    acknowledges: bool = False
    remaining: int = 0
    keeps: Keeps | None = None
    defaults: tuple[Value, ...] = field(init=False)
    saved: tuple[Value, ...] = field(init=False)

    def __post_init__(self) -> None:
        formats.pack_values(self.format, list(dict.fromkeys(self.values)))  # all are values of the format
        self.defaults = self.saved = tuple(self.values)

    def refusal(self, state: str, *, change: bool) -> int | None:
        """Return the error number of the first condition that refuses the access, or None."""
        for condition in self.conditions:
            if (change or condition.read) and condition.refuses(state):
                return condition.error
        return None

    def description(self) -> Description:
        """Return the parameter description, attribute 20h."""
        bits = self.format.code | NO_SCALE
        bits |= READ_ONLY * self.read_only | RESET_ONLY * self.reset_only | ARRAY * self.array
        bits |= TEXT_ARRAY * bool(self.texts) | CHANGED * (tuple(self.values) != self.defaults)
        elements = len(self.values) if self.array else 0
        if self.format.is_string:
            elements = len(formats.pack_values(self.format, self.values))
        lower, upper = self._raw(self.limits.low), self._raw(self.limits.high)
        return Description(bits, elements, name=self.name, lower=lower, upper=upper)

    def _raw(self, limit: float | None) -> bytes:
        if limit is None or self.format.is_string or self.format.size > 4:
            return bytes(4)
        return formats.pack_values(self.format, [limit])


@dataclass(slots=True)
class DriveObject:
    """One drive object (axis): its number, its parameters by number, its operating state."""

    number: int
    parameters: dict[int, SimulatedParameter]
    state: str = READY

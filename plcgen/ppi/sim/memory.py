"""Memory of a simulated S7-200: reads and writes of items with the return codes of a CPU."""

from __future__ import annotations

from plcgen.ppi.wire.areas import ELEMENT_SIZES, OCTETS, Area, ReturnCode, TransportSize
from plcgen.ppi.wire.model import Item, ItemResult
from plcgen.ppi.wire.profiles import TYPE_LENGTH, CpuProfile

READ_ONLY = frozenset({Area.AI, Area.HC, Area.SYS})
READ_ONLY_SM = 30
"""SMB0 to SMB29 belong to the CPU (S7-200 system manual, appendix "Special memory bits")."""

_ALWAYS_ON = 0x01
_ANALOG = frozenset({Area.AI, Area.AQ})
_PLAIN_ONLY = frozenset({TransportSize.BYTE, TransportSize.CHAR})
_ELEMENT_CODES = frozenset(ELEMENT_SIZES.values())


class StationMemory:
    """All areas of one CPU, zero at power-on but for SYS and SM0.0, which is always on.

    ``write_inputs`` False refuses writes to I. That timers and counters can be written, and anything be forced, is what
    one document says; no capture shows it.
    """

    def __init__(self, profile: CpuProfile, type_: str | None = None, *, write_inputs: bool = True) -> None:
        self.profile = profile
        self.write_inputs = write_inputs
        self.forced: dict[Item, bytes] = {}
        self._bytes = {area: bytearray(size * _width(area)) for area, size in profile.sizes.items()}
        text = profile.type if type_ is None else type_
        self._bytes[Area.SM][0] = _ALWAYS_ON
        self._bytes[Area.SYS][:TYPE_LENGTH] = text.encode("ascii", "replace")[:TYPE_LENGTH].ljust(TYPE_LENGTH)

    def read(self, item: Item) -> ItemResult:
        """Answer one item of a read."""
        code = self._check(item)
        return ItemResult(code) if code != ReturnCode.OK else ItemResult.of(item, self._get(item))

    def write(self, item: Item, data: bytes) -> ReturnCode:
        """Execute one item of a write request and return its code; nothing is changed unless it is FFh."""
        code = self._check(item)
        if code == ReturnCode.OK and self._read_only(item):
            code = ReturnCode.ACCESS_DENIED
        if code == ReturnCode.OK and len(data) != item.octets:
            code = ReturnCode.SIZE_MISMATCH
        if code == ReturnCode.OK:
            self.put(item, data)
            self._restore_forced()
        return code

    def put(self, item: Item, data: bytes) -> None:
        """Set a value as the process or the program does, read-only areas too; the item must be in range."""
        if item.size == TransportSize.BIT:
            mask = 1 << item.bit_number
            cell = self._bytes[Area(item.area)]
            cell[item.byte] = cell[item.byte] | mask if data[0] & 1 else cell[item.byte] & ~mask
            return
        start = self._start(item)
        self._bytes[Area(item.area)][start : start + len(data)] = data

    def force(self, item: Item, data: bytes | None) -> ReturnCode:
        """Force an item to a value, or release it with None."""
        code = self._check(item)
        if code != ReturnCode.OK:
            return code
        if data is None:
            self.forced.pop(item, None)
        else:
            self.forced[item] = data
            self._restore_forced()
        return code

    def check(self, item: Item) -> ReturnCode:
        """Return code of an access to an item, without doing it."""
        return self._check(item)

    def _check(self, item: Item) -> ReturnCode:
        area = item.area
        if area not in self._bytes or (area == Area.V and item.db != Area.V.db):
            return ReturnCode.NOT_AVAILABLE
        if area in ELEMENT_SIZES and item.size != ELEMENT_SIZES[Area(area)]:
            return ReturnCode.ACCESS_DENIED  # what a CPU says to T40 as a byte; of C and HC it is assumed
        if not _suits(item):
            return ReturnCode.TYPE_NOT_SUPPORTED
        if item.count == 0:
            return ReturnCode.SIZE_MISMATCH
        if item.size == TransportSize.BIT and item.count != 1:
            return (
                ReturnCode.TYPE_NOT_SUPPORTED
            )  # libnodave, nodave.h: what a CPU 200 says to a bit block longer than 1
        plain = not item.by_element and item.size != TransportSize.BIT
        if plain and (item.bit_number or (area in _ANALOG and item.byte % 2)):
            return ReturnCode.OUT_OF_RANGE
        if self._start(item) + item.octets > len(self._bytes[Area(area)]):
            return ReturnCode.OUT_OF_RANGE
        return ReturnCode.OK

    def _read_only(self, item: Item) -> bool:
        area = item.area
        if area in READ_ONLY or (area == Area.I and not self.write_inputs):
            return True
        return area == Area.SM and item.byte < READ_ONLY_SM

    def _get(self, item: Item) -> bytes:
        cell = self._bytes[Area(item.area)]
        if item.size == TransportSize.BIT:
            return bytes((cell[item.byte] >> item.bit_number & 1,))
        start = self._start(item)
        return bytes(cell[start : start + item.octets])

    def locate(self, item: Item) -> tuple[bytearray, int]:
        """The area of an item that is in range, and where it begins there."""
        return self._bytes[Area(item.area)], item.byte if item.size == TransportSize.BIT else self._start(item)

    def _start(self, item: Item) -> int:
        return item.address * _width(Area(item.area)) if item.by_element else item.address >> 3

    def _restore_forced(self) -> None:
        for item, data in self.forced.items():
            self.put(item, data)


def _width(area: Area) -> int:
    """Bytes of one element: 5 for a timer (status and 32 bits), 3 for a counter, 1 where bytes are addressed."""
    return OCTETS[ELEMENT_SIZES[area]] if area in ELEMENT_SIZES else 1


def _suits(item: Item) -> bool:
    if item.area in ELEMENT_SIZES:
        return True
    if item.size not in OCTETS or item.size in _ELEMENT_CODES:
        return False
    if item.area == Area.SYS:
        return item.size in _PLAIN_ONLY
    return item.area not in _ANALOG or item.size != TransportSize.BIT

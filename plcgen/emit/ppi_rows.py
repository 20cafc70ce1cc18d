"""What every document says about a member of a telegram table or response DB, worked out once."""

from __future__ import annotations

from functools import lru_cache

from plcgen.emit.ppi_master import value_text
from plcgen.emit.rows import Row
from plcgen.emit.spelling import culture, elements, literal, one_line, type_text
from plcgen.plan.model import BlockRef, Project
from plcgen.plan.ppi_model import PpiField, PpiTelegram
from plcgen.ppi.areas import Area, TransportSize
from plcgen.s7.types import ArrayType, Elementary
from plcgen.s7.values import SIGNED, UNSIGNED

_TEXTS: dict[str, tuple[str, str, str]] = {
    "length": ("length of the telegram in bytes", "Länge des Telegramms in Byte", "报文长度（字节）"),
    "start": ("68h = start delimiter SD2", "68h = Startzeichen SD2", "68h = 起始符 SD2"),
    "frame_length": ("LE: bytes from DA to the last of the PDU", "LE: Bytes von DA bis Ende der PDU", "LE: 从 DA 到 PDU 末尾的字节数"),
    "frame_length_2": ("LEr: length repeated", "LEr: Länge wiederholt", "LEr: 重复长度"),
    "start_2": ("68h = start delimiter repeated", "68h = Startzeichen wiederholt", "68h = 重复起始符"),
    "destination": ("DA: address of the station", "DA: Adresse der Station", "DA: 目的地址"),
    "source": ("SA: address of this master", "SA: Adresse dieses Masters", "SA: 源地址"),
    "function_code": ("FC: 6Ch first, then 5Ch, 7Ch in turn", "FC: zuerst 6Ch, dann 5Ch, 7Ch im Wechsel", "FC: 先 6Ch，然后 5Ch、7Ch 交替"),
    "protocol": ("32h = S7 protocol", "32h = S7-Protokoll", "32h = S7 协议"),
    "rosctr": ("01h = job", "01h = Auftrag", "01h = 作业"),
    "reserved": ("reserved, 0", "reserviert, 0", "保留, 0"),
    "reference": ("PDU reference, new in every request", "PDU-Referenz, in jedem Auftrag neu", "PDU 参考号, 每个请求更新"),
    "parameter_length": ("length of the parameters: 2 + 12 per item", "Länge der Parameter: 2 + 12 je Element", "参数长度: 2 + 12 x 项数"),
    "data_length": ("length of the data", "Länge der Daten", "数据长度"),
    "service": ("04h = read, 05h = write, 28h = RUN, 29h = STOP", "04h = lesen, 05h = schreiben, 28h = RUN, 29h = STOP", "04h = 读, 05h = 写, 28h = RUN, 29h = STOP"),
    "item_count": ("number of items", "Anzahl der Elemente", "项数"),
    "specification": ("12h = address specification", "12h = Adressangabe", "12h = 地址说明"),
    "address_length": ("0Ah = ten bytes follow", "0Ah = zehn Bytes folgen", "0Ah = 后跟 10 字节"),
    "syntax": ("10h = S7 any pointer", "10h = S7-Any-Zeiger", "10h = S7-ANY 指针"),
    "transport_size": ("01h = bit, 02h = byte, 04h = word, 06h = double word", "01h = Bit, 02h = Byte, 04h = Wort, 06h = Doppelwort", "01h = 位, 02h = 字节, 04h = 字, 06h = 双字"),
    "count": ("number of elements", "Anzahl", "元素数量"),
    "db": ("1 for V, else 0", "1 bei V, sonst 0", "V 区为 1, 其它为 0"),
    "area": ("area: 81h = I, 82h = Q, 83h = M, 84h = V", "Bereich: 81h = E, 82h = A, 83h = M, 84h = V", "存储区: 81h = I, 82h = Q, 83h = M, 84h = V"),
    "address_high": ("byte * 8 + bit, highest byte", "Byte * 8 + Bit, höchstes Byte", "字节 x 8 + 位, 高字节"),
    "address": ("byte * 8 + bit", "Byte * 8 + Bit", "字节 x 8 + 位"),
    "return_code": ("return code: FFh = good", "Rückgabewert: FFh = gut", "返回码: FFh = 正确"),
    "size_code": ("03h = bit, 04h = length in bits, 09h = in bytes", "03h = Bit, 04h = Länge in Bit, 09h = in Byte", "03h = 位, 04h = 位长度, 09h = 字节长度"),
    "value_length": ("length of the value", "Länge des Werts", "数值长度"),
    "value": ("value", "Wert", "数值"),
    "pad": ("pad byte", "Füllbyte", "填充字节"),
    "service_mark": ("FDh", "FDh", "FDh"),
    "argument_length": ("no arguments", "keine Argumente", "无参数"),
    "program": ("09h and the service P_PROGRAM", "09h und der Dienst P_PROGRAM", "09h 和服务 P_PROGRAM"),
    "fcs": ("FCS: sum of all bytes from DA on, modulo 256", "FCS: Summe aller Bytes ab DA, modulo 256", "FCS: 从 DA 起所有字节之和 mod 256"),
    "end": ("16h = end delimiter", "16h = Endezeichen", "16h = 结束符"),
}  # fmt: skip
"""Meaning of each member: en, de, zh; other languages fall back to English."""
_COLUMN = {"en": 0, "de": 1, "zh": 2}
_LETTER = {8: "DBB", 16: "DBW", 32: "DBD"}
_INTEGERS = SIGNED | UNSIGNED
WATCHED = 8


@lru_cache(maxsize=64)
def table_rows(project: Project, telegram: PpiTelegram) -> list[Row]:
    """Rows of the telegram table."""
    return [_row(project, telegram, telegram.request_db, f, "telegram.") for f in telegram.request_fields]


@lru_cache(maxsize=64)
def answer_rows(project: Project, telegram: PpiTelegram) -> list[Row]:
    """Rows of the response DB; none if the reply has no data."""
    if telegram.response_db is None:
        return []
    return [_row(project, telegram, telegram.response_db, f, "") for f in telegram.response_fields]


def _row(project: Project, telegram: PpiTelegram, db: BlockRef, field: PpiField, prefix: str) -> Row:
    where = project.target
    type_, start = field.type, ""
    subs: tuple[tuple[int, str], ...] = ()
    if isinstance(type_, Elementary) and any(field.data):
        start = literal(type_, field.data, v5=where.v5)
    elif isinstance(type_, ArrayType) and any(field.data):
        subs = tuple(elements(type_, field.data, v5=where.v5))
    texts = {language: _text(project, telegram, field, language) for language in project.languages}
    main = _text(project, telegram, field, "en") if where.v5 else texts[project.languages[0]]
    return Row(
        name=field.name,
        type=type_text(type_, tia=not where.v5),
        start=start,
        subs=subs,
        text=main,
        comments=tuple((culture(language), text) for language, text in texts.items()),
        offset=field.offset,
        size=field.size,
        address=f"DB{db.number}.{_LETTER.get(_bits(field), 'DBB')}{field.offset}",
        watch=_watch(db, field, prefix),
    )


def _bits(field: PpiField) -> int:
    return field.type.bits if isinstance(field.type, Elementary) else 8


def _text(project: Project, telegram: PpiTelegram, field: PpiField, language: str) -> str:
    """Comment of a member in a language, with the addresses where it belongs to an item."""
    text = _TEXTS[field.role][_COLUMN.get(language[:2].lower(), 0)]
    if not field.item:
        return text
    if field.role == "value" and len(field.placed) == 1:
        return value_text(project, field.placed[0].value)
    wire = telegram.items[field.item - 1]
    labels = ", ".join(placed.value.label for placed in wire.values) or Area(wire.item.area).title
    if field.role == "transport_size":
        text = f"{wire.item.size:02X}h = {TransportSize(wire.item.size).name.lower().replace('_', ' ')}"
    if field.role == "area":
        text = f"{wire.item.area:02X}h = {Area(wire.item.area).name}"
    return one_line(f"{labels}: {text}")


def _watch(db: BlockRef, field: PpiField, prefix: str) -> tuple[tuple[str, str, str, str], ...]:
    """Watch lines of a member: one, or one per array element up to ``WATCHED``; nothing is to be modified."""
    if field.role == "pad":
        return ()
    type_ = field.type
    element = type_.element if isinstance(type_, ArrayType) else type_
    if not isinstance(element, Elementary):
        return ()
    shown = "FloatingPoint" if element.name == "REAL" else "DEC" if element.name in _INTEGERS else "Hex"
    shown = "Character" if element.name == "CHAR" else shown
    letter = _LETTER.get(element.bits, "DBB")
    name = f'"{db.name}".{prefix}{field.name}'
    if not isinstance(type_, ArrayType):
        return ((name, f"DB{db.number}.{letter}{field.offset}", shown, ""),)
    low, high = type_.bounds[0]
    step = element.bits // 8
    count = min(high - low + 1, WATCHED)
    return tuple(
        (f"{name}[{low + n}]", f"DB{db.number}.{letter}{field.offset + n * step}", shown, "") for n in range(count)
    )

"""What each field of a PPI telegram means, in the languages the field speaks: en, de, zh (others get English)."""

from __future__ import annotations

FIELD_TEXTS: dict[str, tuple[str, str, str]] = {
    "length": ("length of the telegram in bytes", "Länge des Telegramms in Byte", "报文长度（字节）"),
    "start": ("68h = start delimiter SD2", "68h = Startzeichen SD2", "68h = 起始符 SD2"),
    "frame_length": (
        "LE: bytes from DA to the last of the PDU",
        "LE: Bytes von DA bis Ende der PDU",
        "LE: 从 DA 到 PDU 末尾的字节数",
    ),
    "frame_length_2": ("LEr: length repeated", "LEr: Länge wiederholt", "LEr: 重复长度"),
    "start_2": ("68h = start delimiter repeated", "68h = Startzeichen wiederholt", "68h = 重复起始符"),
    "destination": ("DA: address of the station", "DA: Adresse der Station", "DA: 目的地址"),
    "source": ("SA: address of this master", "SA: Adresse dieses Masters", "SA: 源地址"),
    "function_code": (
        "FC: 6Ch first, then 5Ch, 7Ch in turn",
        "FC: zuerst 6Ch, dann 5Ch, 7Ch im Wechsel",
        "FC: 先 6Ch，然后 5Ch、7Ch 交替",
    ),
    "protocol": ("32h = S7 protocol", "32h = S7-Protokoll", "32h = S7 协议"),
    "rosctr": ("01h = job", "01h = Auftrag", "01h = 作业"),
    "reserved": ("reserved, 0", "reserviert, 0", "保留, 0"),
    "reference": (
        "PDU reference, new in every request",
        "PDU-Referenz, in jedem Auftrag neu",
        "PDU 参考号, 每个请求更新",
    ),
    "parameter_length": (
        "length of the parameters: 2 + 12 per item",
        "Länge der Parameter: 2 + 12 je Element",
        "参数长度: 2 + 12 x 项数",
    ),
    "data_length": ("length of the data", "Länge der Daten", "数据长度"),
    "service": (
        "04h = read, 05h = write, 28h = RUN, 29h = STOP",
        "04h = lesen, 05h = schreiben, 28h = RUN, 29h = STOP",
        "04h = 读, 05h = 写, 28h = RUN, 29h = STOP",
    ),
    "item_count": ("number of items", "Anzahl der Elemente", "项数"),
    "specification": ("12h = address specification", "12h = Adressangabe", "12h = 地址说明"),
    "address_length": ("0Ah = ten bytes follow", "0Ah = zehn Bytes folgen", "0Ah = 后跟 10 字节"),
    "syntax": ("10h = S7 any pointer", "10h = S7-Any-Zeiger", "10h = S7-ANY 指针"),
    "transport_size": (
        "01h = bit, 02h = byte, 04h = word, 06h = double word",
        "01h = Bit, 02h = Byte, 04h = Wort, 06h = Doppelwort",
        "01h = 位, 02h = 字节, 04h = 字, 06h = 双字",
    ),
    "count": ("number of elements", "Anzahl", "元素数量"),
    "db": ("1 for V, else 0", "1 bei V, sonst 0", "V 区为 1, 其它为 0"),
    "area": (
        "area: 81h = I, 82h = Q, 83h = M, 84h = V",
        "Bereich: 81h = E, 82h = A, 83h = M, 84h = V",
        "存储区: 81h = I, 82h = Q, 83h = M, 84h = V",
    ),
    "address_high": ("byte * 8 + bit, highest byte", "Byte * 8 + Bit, höchstes Byte", "字节 x 8 + 位, 高字节"),
    "address": ("byte * 8 + bit", "Byte * 8 + Bit", "字节 x 8 + 位"),
    "return_code": ("return code: FFh = good", "Rückgabewert: FFh = gut", "返回码: FFh = 正确"),
    "size_code": (
        "03h = bit, 04h = length in bits, 09h = in bytes",
        "03h = Bit, 04h = Länge in Bit, 09h = in Byte",
        "03h = 位, 04h = 位长度, 09h = 字节长度",
    ),
    "value_length": ("length of the value", "Länge des Werts", "数值长度"),
    "value": ("value", "Wert", "数值"),
    "pad": ("pad byte", "Füllbyte", "填充字节"),
    "service_mark": ("FDh", "FDh", "FDh"),
    "argument_length": ("no arguments", "keine Argumente", "无参数"),
    "program": ("09h and the service P_PROGRAM", "09h und der Dienst P_PROGRAM", "09h 和服务 P_PROGRAM"),
    "fcs": (
        "FCS: sum of all bytes from DA on, modulo 256",
        "FCS: Summe aller Bytes ab DA, modulo 256",
        "FCS: 从 DA 起所有字节之和 mod 256",
    ),
    "end": ("16h = end delimiter", "16h = Endezeichen", "16h = 结束符"),
}
"""Meaning of each member: en, de, zh; other languages fall back to English."""

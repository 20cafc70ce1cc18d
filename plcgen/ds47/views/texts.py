"""What each telegram field means, in the languages the field speaks: en, de, zh (others fall back to English)."""

from __future__ import annotations

from plcgen.build.phrases import translated
from plcgen.ds47.plan.access import Use
from plcgen.ds47.plan.nouns import DriveField

_REQUEST: dict[str, tuple[str, str, str]] = {
    "reference": ("request reference 1..255", "Auftragsreferenz 1..255", "请求参考 1..255"),
    "request_id": ("01h = read, 02h = write", "01h = lesen, 02h = schreiben", "01h = 读请求, 02h = 写请求"),
    "drive_object": ("drive object (axis)", "Antriebsobjekt (Achse)", "驱动对象（轴）"),
    "count": ("number of parameters", "Anzahl Parameter", "参数数量"),
    "attribute": ("10h = value", "10h = Wert", "10h = 数值"),
    "elements": ("number of elements", "Anzahl Elemente", "元素数量"),
    "pnu": ("parameter number", "Parameternummer", "参数号"),
    "subindex": ("subindex", "Subindex", "下标"),
    "format": ("data format", "Datenformat", "格式"),
    "value_count": ("number of values", "Anzahl Werte", "数值数量"),
    "value": ("value", "Wert", "参数值"),
    "pad": ("pad byte", "Füllbyte", "填充字节"),
}
_RESPONSE = _REQUEST | {
    "reference": ("mirrored request reference", "gespiegelte Auftragsreferenz", "请求参考镜像"),
    "request_id": (
        "01h/02h = good, 81h/82h = error",
        "01h/02h = gut, 81h/82h = Fehler",
        "01h/02h = 正确, 81h/82h = 错误",
    ),
    "drive_object": ("mirrored drive object", "gespiegeltes Antriebsobjekt", "驱动对象镜像"),
    "error_format": ("44h = error", "44h = Fehler", "44h = 错误"),
    "error_count": ("number of error words", "Anzahl Fehlerworte", "错误字数量"),
    "error_number": ("error number", "Fehlernummer", "错误值"),
    "error_info": ("second error word", "zweites Fehlerwort", "第二错误字"),
    "reserve": (
        "room for the longest error answer",
        "Platz für die längste Fehlerantwort",
        "错误应答的预留空间",
    ),
}
_COLUMN = {"en": 0, "de": 1, "zh": 2}


def field_texts(field: DriveField, languages: tuple[str, ...], *, response: bool) -> list[tuple[str, str]]:
    """Comment of a member in each language, with the parameter and its unit where it belongs to one."""
    row = (_RESPONSE if response else _REQUEST)[field.role]
    part = field.part
    texts = []
    for language in languages:
        text = row[_COLUMN.get(language[:2].lower(), 0)]
        if part is not None and field.role == "value":
            text = _value_text(part.use, language, text)
        elif part is not None:
            text = f"{part.use.label} {text}"
        texts.append((language, text))
    return texts


def _value_text(use: Use, language: str, word: str) -> str:
    """Parameter, what the spec or the catalogue calls it (else the mere ``word`` for a value), unit."""
    parameter = use.parameter
    unit = f" [{parameter.unit}]" if parameter.unit else ""
    if use.comment.get(language) or not parameter.title:
        return f"{use.label} {use.comment.get(language) or word}{unit}"
    english = f"{use.label} {parameter.title}{unit}"
    return translated(english).get(language[:2].lower(), english)

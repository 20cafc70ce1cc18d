"""What every code and number means: diagnostics, DS47 error numbers, status words, STATUS double words."""

from __future__ import annotations

import re

from plcgen.diagnostics.codes import all_codes
from plcgen.diagnostics.codes import code as code_info
from plcgen.output.page import Page
from plcgen.output.view import PLAIN

_NUMBER = re.compile(r"(?:(?:B|W|DW|BYTE|WORD|DWORD)#)?(?:16#|0x|\$)?([0-9a-f_]{1,10})(h?)\Z", re.IGNORECASE)
_CODE = re.compile(r"PG[0-9]{3}\Z", re.IGNORECASE)


def explain_page(key: str) -> Page | None:
    """Explain ``PG209``, ``0x11`` (DS47 error), ``16#8101`` (status word) or ``DF80B500`` (STATUS); None: unknown.

    The number of hexadecimal digits decides: one or two an error number, four a word, eight a double word.
    """
    text = key.strip()
    if _CODE.match(text):
        return _diagnostic(text.upper())
    match = _NUMBER.match(text)
    if match is None:
        return None
    digits = match[1].replace("_", "")
    value = int(digits, 16) if digits else 0
    if len(digits) <= 2 or (len(digits) == 4 and digits.startswith("00")):
        return error_page(value)
    if len(digits) == 4:
        return word_page(value)
    return status_page(value) if len(digits) == 8 else None


def _diagnostic(code: str) -> Page | None:
    try:
        info = code_info(code)
    except KeyError:
        return None
    sections = (("Why", info.why), ("Fix", info.fix), ("Wrong", info.bad), ("Right", info.good))
    return Page(code, f"{info.severity.label}: {info.title}", sections)


def error_page(number: int) -> Page:
    """Explain an error number of data set 47."""
    from plcgen.protocols.ds47.wire.errors import MANUFACTURER_FIRST, error_text

    error = error_text(number)
    info = {"none": "0 or absent", "subindex": "the subindex that failed"}.get(error.info, error.info)
    sections = [("Information word", info), ("Source", error.origin)]
    if error.note:
        sections.append(("Note", error.note))
    if number >= MANUFACTURER_FIRST:
        sections.append(
            ("Note", "65h to FFh belong to the manufacturer: this is the SINAMICS meaning, other drives differ")
        )
    return Page(f"{number:02X}h", f"DS47 error number: {error.meaning}", tuple(sections))


def word_page(word: int) -> Page:
    """Explain the status word of a generated block, or else the middle word of a STATUS."""
    from plcgen.protocols.ds47.wire.status import explain_word
    from plcgen.protocols.ds47.words import STATUS_WORDS

    known = {value: (name, text) for name, value, text in STATUS_WORDS}
    status = explain_word(word)
    record = ("As the middle word of a WRREC or RDREC STATUS", status.text)
    if word not in known:
        return Page(f"16#{word:04X}", "not a status word of a generated block", (record,))
    name, text = known[word]
    sections = (("Constant", name), record) if word >> 8 == 0x70 else (("Constant", name),)
    return Page(f"16#{word:04X}", f"block status: {text}", sections)


def status_page(value: int) -> Page:
    """Explain a STATUS double word of WRREC or RDREC."""
    from plcgen.protocols.ds47.texts import status_text
    from plcgen.protocols.ds47.wire.status import explain

    status = explain(value)
    table = "\n".join(line.strip() for line in status_text(status, PLAIN).splitlines()[1:])
    return Page(f"{value:08X}h", f"STATUS: {status.text}", (("Bytes", table),))


def list_codes() -> list[tuple[str, str, str]]:
    """Every diagnostic code with severity and title, in order."""
    return [(code, code_info(code).severity.label, code_info(code).title) for code in sorted(all_codes())]


def known_keys() -> list[str]:
    """Codes for "did you mean"."""
    return sorted(all_codes())

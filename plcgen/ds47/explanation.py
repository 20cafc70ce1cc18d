"""What the numbers of the parameter channel mean: error numbers, status words of blocks, STATUS double words."""

from __future__ import annotations

import tomllib
from pathlib import Path

from plcgen.base.display.page import Page
from plcgen.base.display.view import PLAIN
from plcgen.ds47.texts import status_text
from plcgen.ds47.wire.errors import MANUFACTURER_FIRST, error_text, known_numbers
from plcgen.ds47.wire.status import explain_codes, explain_status, explain_word
from plcgen.ds47.words import STATUS_WORDS

_TERMS = Path(__file__).with_name("terms.toml")
_CODES = range(0xA0, 0xF0)
"""Error_Code_1 that a drive or module gives; as Error_Decode they do not exist."""

_NOTES = {
    0x8501: "In a job with on_error: restore and save: the values are right, but not known to be saved. cause says why,"
    " for example 8501 if the drive has not finished within the limit, or 8401 if the drive refused to save.",
}
"""What a status word means in some jobs only; its text, which is in generated blocks, leaves that out."""

_OTHERS = "SINA_POS, SINA_PARA, LAcycCom and others have words of their own with the same numbers: see their help"


def explain(digits: str) -> Page | None:
    """One or two hexadecimal digits are an error number, four a status word, eight a STATUS."""
    value = int(digits, 16)
    if len(digits) <= 2 or (len(digits) == 4 and digits.startswith("00")):
        return error_page(value)
    if len(digits) == 4:
        return word_page(value)
    return status_page(value) if len(digits) == 8 else None


def term_page(word: str) -> Page | None:
    """What a term of the parameter channel means; None for anything else."""
    for term in tomllib.loads(_TERMS.read_text("utf-8"))["terms"]:
        if " ".join(word.lower().split()) in term["spellings"]:
            sections = (("Here", term["here"]), ("Source", term["source"]))
            return Page(term["title"], term["means"], sections)
    return None


def error_page(number: int) -> Page:
    """Explain an error number of data set 47."""
    error = error_text(number)
    info = {"none": "0 or absent", "subindex": "the subindex that failed"}.get(error.info, error.info)
    sections = [("Information word", info), ("Source", error.origin)]
    if error.note:
        sections.append(("Note", error.note))
    if number >= MANUFACTURER_FIRST and number in known_numbers():
        sections.append(
            ("Note", "65h to FFh belong to the manufacturer: this is the SINAMICS meaning, other drives differ")
        )
    return Page(f"{number:02X}h", f"DS47 error number: {error.meaning}", tuple(sections))


def word_page(word: int) -> Page:
    """Explain the status word of a generated block, or else a word of a STATUS: the middle one, or the lower one."""
    known = {value: (name, text) for name, value, text in STATUS_WORDS}
    record = ("As the middle word of a WRREC or RDREC STATUS", explain_word(word).text)
    if word >> 8 in _CODES:
        record = ("As the lower word of a WRREC or RDREC STATUS", explain_codes(word).text)
    others = [("Of other blocks", _OTHERS)] if word >> 12 == 0x8 else []
    if word not in known:
        return Page(f"16#{word:04X}", "not a status word of a generated block", (record, *others))
    name, text = known[word]
    sections = [("Constant", name)]
    if word >> 8 == 0x70:
        sections.append(record)
    if word in _NOTES:
        sections.append(("Note", _NOTES[word]))
    sections += others
    return Page(f"16#{word:04X}", f"block status: {text}", tuple(sections))


def status_page(value: int) -> Page:
    """Explain a STATUS double word of WRREC or RDREC."""
    status = explain_status(value)
    table = "\n".join(line.strip() for line in status_text(status, PLAIN).splitlines()[1:])
    return Page(f"{value:08X}h", f"STATUS: {status.text}", (("Bytes", table),))

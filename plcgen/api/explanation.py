"""What every code and number means: diagnostics of plcgen, then the numbers of its protocols."""

from __future__ import annotations

import dataclasses
import re

from plcgen.base.diagnostics.codes import all_codes
from plcgen.base.diagnostics.codes import code as code_info
from plcgen.base.display.page import Page
from plcgen.ds47 import hardware
from plcgen.ds47.explanation import term_page
from plcgen.project.registry import protocols

_NUMBER = re.compile(r"(?:(?:B|W|DW|BYTE|WORD|DWORD)#)?(?:16#|0x|\$)?([0-9a-f_]{1,10})(h?)\Z", re.IGNORECASE)
_OF_DRIVES = re.compile(r"(?![AFC][0-9]{3}\Z)[FANCPR] *[0-9]|[0-9]{5}\Z", re.IGNORECASE)
"""What may be a message or a parameter: four hexadecimal digits are a word."""
_BLOCK = re.compile(r"(DB|FB|FC) ?([0-9]{1,5})\Z", re.IGNORECASE)
"""Hexadecimal digits, too, but everybody who writes ``DB47`` means the block."""
_FOUR = re.compile(r"[0-9]{4}\Z")
_SINK = re.compile(r"C[0-9]{3}\Z", re.IGNORECASE)
_CODE = re.compile(r"PG[0-9]{3}\Z", re.IGNORECASE)


def explain_page(key: str, device: str = "") -> Page | None:
    """Explain ``PG209``, ``0x11`` (DS47 error), ``16#8101`` (status word), ``DF80B500`` (STATUS), ``hardware-id``,
    ``PKW`` (term), ``F30001`` (message), ``r2 = 42`` (parameter); the last two of a device, or of all.

    Raises:
        DiagnosticError: PG201 if there is no such device.
    """
    text = key.strip()
    if _OF_DRIVES.match(text):
        from plcgen.ds47.lookup import message_page, parameter_page

        page = message_page(text, device) or parameter_page(text, device)
        if page is not None:
            return page
    if _CODE.match(text):
        return _diagnostic(text.upper())
    if text.lower() == hardware.SUBJECT:
        return hardware.hardware_page()
    term = term_page(text)
    if term is not None:
        return term
    block = _BLOCK.match(text)
    if block is not None:
        return _block_page(block[1].upper(), int(block[2]))
    match = _NUMBER.match(text)
    digits = match[1].replace("_", "") if match else ""
    pages = [page for protocol in protocols() if match and (page := protocol.explain(digits)) is not None]
    if not pages:
        return None
    sections = tuple(section for page in pages for section in page.sections)
    sections += _of_a_drive(text, device)
    return dataclasses.replace(pages[0], sections=sections)


def _block_page(kind: str, number: int) -> Page:
    """A block by its number, which is no number of a drive."""
    here = "automatic numbers of generated blocks begin where numbers: of the spec says (docs/spec.md)"
    sections = [("Here", f"{here}; plcgen layout lists what is in a DB")]
    if number == 47:
        sections.append(("Not to be confused", "data record 47 of a drive, the parameter channel: plcgen explain DS47"))
    elif kind != "FC":
        sections.append(("Not to be confused", f"a word of a STATUS: plcgen explain 16#{kind}{number}"))
    return Page(f"{kind}{number}", "a block of the PLC program", tuple(sections))


def _of_a_drive(text: str, device: str) -> tuple[tuple[str, str], ...]:
    """Four digits are the number of a message, too, if its first digit is left out, 7901 of F07901; C840 is a sink."""
    four = _FOUR.match(text)
    if not four and not _SINK.match(text):
        return ()
    from plcgen.ds47.lookup import message_page, parameter_page

    what, asked = ("message", f"0{text}") if four else ("parameter", f"c0{text[1:]}")
    page = message_page(asked, device) if four else parameter_page(asked, device)
    return () if page is None else ((f"As a {what} of a drive", f"{page.key}: {page.title}; plcgen explain {asked}"),)


def _diagnostic(code: str) -> Page | None:
    try:
        info = code_info(code)
    except KeyError:
        return None
    sections = (("Why", info.why), ("Fix", info.fix), ("Wrong", info.bad), ("Right", info.good))
    return Page(code, f"{info.levels}: {info.title}", sections)


def list_codes() -> list[tuple[str, str, str]]:
    """Every diagnostic code with severity and title, in order."""
    return [(code, code_info(code).severity.label, code_info(code).title) for code in sorted(all_codes())]


def known_keys() -> list[str]:
    """Codes and subjects for "did you mean"."""
    return [*sorted(all_codes()), hardware.SUBJECT]

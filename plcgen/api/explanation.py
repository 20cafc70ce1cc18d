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
    match = _NUMBER.match(text)
    digits = match[1].replace("_", "") if match else ""
    pages = [page for protocol in protocols() if match and (page := protocol.explain(digits)) is not None]
    if not pages:
        return None
    sections = tuple(section for page in pages for section in page.sections)
    return dataclasses.replace(pages[0], sections=sections)


def _diagnostic(code: str) -> Page | None:
    try:
        info = code_info(code)
    except KeyError:
        return None
    sections = (("Why", info.why), ("Fix", info.fix), ("Wrong", info.bad), ("Right", info.good))
    return Page(code, f"{info.severity.label}: {info.title}", sections)


def list_codes() -> list[tuple[str, str, str]]:
    """Every diagnostic code with severity and title, in order."""
    return [(code, code_info(code).severity.label, code_info(code).title) for code in sorted(all_codes())]


def known_keys() -> list[str]:
    """Codes and subjects for "did you mean"."""
    return [*sorted(all_codes()), hardware.SUBJECT]

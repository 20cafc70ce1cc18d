"""Round trips of code, and what counts as the same token."""

from __future__ import annotations

from plcgen.base.diagnostics import Diagnostic
from plcgen.s7.scl.cursor import unquote
from plcgen.s7.scl.lexer import ADDRESS, KEYWORDS, LOCAL, NAME, QUOTED, tokenize
from plcgen.s7.types.blocks import Block, BlockKind
from plcgen.s7.xml.reading.documents import read_simaticml
from plcgen.s7.xml.spelling import VERSIONS, address
from plcgen.s7.xml.writing.documents import Setting, document
from plcgen.s7.xml.writing.elements import BlockScope
from plcgen.s7.xml.writing.structured_text import elements, numbered

SETTING = Setting(VERSIONS["V18"], classic=False)


def network(code: str, scope: BlockScope | None = None, setting: Setting = SETTING) -> str:
    """Numbered elements of a code."""
    return numbered(elements(tokenize(code, "code"), 0, len(code), scope or BlockScope(), setting))


def wrapped(code: str, scope: BlockScope | None = None) -> str:
    """A document of an FB around a code."""
    block = Block(BlockKind.FB, "X", (), code=code, optimized=False)
    return document(block, SETTING, network(code, scope))[0]


def back(code: str, scope: BlockScope | None = None) -> tuple[str, list[Diagnostic]]:
    """SCL -> SimaticML -> SCL."""
    return read_code(wrapped(code, scope))


def read_code(text: str) -> tuple[str, list[Diagnostic]]:
    """Code of the only block of a document."""
    blocks, diagnostics = read_simaticml(text.encode(), "x.xml")
    assert len(blocks) == 1
    return blocks[0].code or "", diagnostics


def exact(code: str) -> list[tuple[str, str]]:
    """Kinds and texts; keywords in upper case."""
    tokens = tokenize(code, "code")
    return [(k, k if k in KEYWORDS else t) for k, t in zip(tokens.kinds, tokens.texts, strict=True)]


def meant(code: str) -> list[str]:
    """Tokens without # and quotes, absolute operands in one spelling: what bare names of old sources become."""
    tokens = tokenize(code, "code")
    found = []
    for kind, text in zip(tokens.kinds, tokens.texts, strict=True):
        if kind in {LOCAL, NAME, QUOTED}:
            found.append(unquote(text.removeprefix("#")))
        elif kind == ADDRESS and (operand := address(text)):
            found.append(operand.text)
        else:
            found.append(kind if kind in KEYWORDS and found[-1:] != ["."] else text)
    return found

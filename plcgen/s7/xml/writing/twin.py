"""The document of a generated code block, made from the text of its source: both can never differ."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from plcgen.s7.scl.lexer import tokenize
from plcgen.s7.types.blocks import Block, SectionKind
from plcgen.s7.xml.writing.documents import Setting, document
from plcgen.s7.xml.writing.scope import BlockScope
from plcgen.s7.xml.writing.structured_text import elements, numbered

if TYPE_CHECKING:
    from collections.abc import Sequence


def code_document(block: Block, setting: Setting, known: Sequence[Block] = ()) -> str:
    """Document of an FB, FC or OB; ``known`` are the blocks it may call."""
    text = block.code or ""
    code = elements(tokenize(text, "generated"), 0, len(text), BlockScope.of(block, known), setting)
    return document(block, setting, numbered(code))[0]


def instance_document(instance: Block, of: Block, setting: Setting) -> str:
    """Document of an instance DB with the interface of its function block."""
    inside = {SectionKind.INPUT, SectionKind.OUTPUT, SectionKind.IN_OUT, SectionKind.STATIC}
    return document(replace(instance, sections=tuple(s for s in of.sections if s.kind in inside)), setting)[0]

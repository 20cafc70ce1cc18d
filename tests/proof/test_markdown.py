"""Lines of Markdown are read as a viewer shows them: escapes and entities stand for one character, code for itself."""

from __future__ import annotations

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from plcgen.base.display.markdown import code_span, escape
from plcgen.proof.folder import plain, rendered

TEXTS = st.text(st.characters(min_codepoint=32, max_codepoint=126), max_size=12)


@given(TEXTS)
@example("a\\b \\\\ &lt; &amp;amp; `c` <d> |e| \\`f\\`")
def test_what_is_written_is_read(text: str) -> None:
    """Every text, and every text as code."""
    assert rendered(escape(text)) == plain(text)
    assert rendered(code_span(text)) == plain(code_span(text))


@pytest.mark.parametrize(
    ("line", "shown"),
    [
        (r"a\\b", r"a\b"),
        (r"a\b", r"a\b"),  # no escape in front of a letter
        (r"`a\\b` and \`c\`", r"`a\\b` and `c`"),
        ("a &amp;lt; b", "a &lt; b"),
        ("``a ` b\\_`` &lt;", "``a ` b\\_`` <"),
    ],
)
def test_examples(line: str, shown: str) -> None:
    """As CommonMark 0.31 has them: 2.4 backslash escapes, 2.5 entities, 6.1 code spans."""
    assert rendered(line) == shown

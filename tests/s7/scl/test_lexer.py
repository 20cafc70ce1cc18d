"""Tokens, places and what lies between them."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from plcgen.s7.scl.lexer import EOF, Comment, tokenize

PIECES = st.sampled_from(
    ["(*", "*)", "(/*", "*/)", "//", "\n", "\r\n", "'", "$'", '"', "#", "%", "P#", "T#", "DB1.", "1", ".", "..",
     "E5", "é", " ", "IF", ":=", "{", "\x00", "M5", "$>", "$<", "16#", "٣"]
)  # fmt: skip


def _pairs(text: str) -> list[tuple[str, str]]:
    tokens = tokenize(text, "t.scl")
    return list(zip(tokens.kinds[:-1], tokens.texts[:-1], strict=True))


def test_every_kind_of_token_is_told_apart() -> None:
    """Kinds follow the spelling: local, quoted, address, literal, pointer, keyword, name."""
    assert _pairs("#a \"b\" %MW2 MW2 16#FF 1.5 'x' T#1s P#M0.0 if x_1") == [
        ("local", "#a"),
        ("quoted", '"b"'),
        ("address", "%MW2"),
        ("address", "MW2"),
        ("int", "16#FF"),
        ("real", "1.5"),
        ("string", "'x'"),
        ("typed", "T#1s"),
        ("pointer", "P#M0.0"),
        ("IF", "if"),
        ("name", "x_1"),
    ]


def test_a_range_of_integers_is_no_real() -> None:
    """``1..5`` is two integers."""
    assert _pairs("1..5") == [("int", "1"), ("..", ".."), ("int", "5")]


def test_names_that_only_look_like_addresses_stay_names() -> None:
    """Without a bit number or width, M1, E2 and DB7 are names; MD5x is one too."""
    assert [kind for kind, _ in _pairs("M1 E2 DB7 MD5x")] == ["name"] * 4


def test_a_string_goes_on_behind_an_interruption() -> None:
    """STEP 7 V5 continues a string on the next line between $> and $<."""
    assert _pairs("'abc$>\n  $<def'") == [("string", "'abc$>\n  $<def'")]


def test_positions_count_from_one_whatever_the_line_end() -> None:
    """CRLF, LF and a lone CR end a line; columns are characters."""
    tokens = tokenize("é a\r\n b\rc", "t.scl")
    places = [tokens.position(start) for start in tokens.starts]
    assert places == [(1, 1), (1, 3), (2, 2), (3, 1), (3, 2)]
    assert str(tokens.span(tokens.starts[2], tokens.end(2))) == "t.scl:2:2"


def test_comments_and_line_breaks_can_be_had_back() -> None:
    """The gap before a token yields its comments and line breaks in order, nested ones as one."""
    tokens = tokenize("a // x\n(* y (* z *) *) (/* m */) b", "t.scl")
    assert tokens.trivia_before(1) == [
        Comment("// x", 2),
        Comment("\n", 6),
        Comment("(* y (* z *) *)", 7),
        Comment("(/* m */)", 23),
    ]
    assert tokens.trivia_before(0) == []


def test_comments_that_do_not_nest_are_read_the_plain_way() -> None:
    """With STEP 7 V5's option off ``(* (* *)`` is complete: the plain reading counts if nesting finds no end."""
    assert _pairs("a (* (* *) b (* c *) d") == [("name", "a"), ("name", "b"), ("name", "d")]


def test_an_open_comment_takes_the_rest() -> None:
    """It becomes one error token, so that it is reported once."""
    assert _pairs("a (* b\nc") == [("name", "a"), ("error", "(* b\nc")]
    assert _pairs("a (/* b\nc") == [("name", "a"), ("error", "(/* b\nc")]


@given(st.lists(PIECES, max_size=60).map("".join))
def test_tokens_and_gaps_are_the_source(text: str) -> None:
    """Nothing is lost: tokens lie in order and a gap holds blanks and comments only."""
    tokens = tokenize(text, "t.scl")
    assert tokens.kinds[-1] == EOF
    end = 0
    for index, start in enumerate(tokens.starts):
        gap = tokens.source[end:start]
        rebuilt = gap
        for comment in tokens.trivia_before(index):
            assert tokens.source.startswith(comment.text, comment.start)
            rebuilt = rebuilt.replace(comment.text, "", 1)
        assert rebuilt.strip() == ""
        assert tokens.source.startswith(tokens.texts[index], start)
        end = tokens.end(index)
    assert end == len(tokens.source)

"""Examples are found in the help as it stands in a copy: code behind ``SCL`` up to the first sentence."""

from tests.evidence.help import examples, problem

PAGE = """### TON: Generate on-delay (S7-1200)

#### Example

The following example shows it:

SCL

`IF "a" &lt; 3 THEN`

`"b"(IN := "c",`

`PT := T#1s);`

END_IF;

The operand "a" starts the timer.

### FOR: Run (S7-1500)

SCL

"x" = 5;

---
"""


def test_code_ends_at_the_first_sentence():
    """Headings, entities and marks go away; a sentence with quoted names is no code."""
    assert list(examples(PAGE)) == [
        ("TON", 'IF "a" < 3 THEN\n"b"(IN := "c",\nPT := T#1s);\nEND_IF;'),
        ("FOR", '"x" = 5;'),
    ]


def test_what_is_refused_is_named():
    """A form that is no SCL has a code and a reason, the rest nothing."""
    (_, good), (_, bad) = examples(PAGE)
    assert problem(good) == []
    assert [text.split()[0] for text in problem(bad)] == ["PG801"]

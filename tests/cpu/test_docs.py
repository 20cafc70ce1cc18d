"""The examples of the page about the soft CPU are executed as they stand."""

import re
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "soft-cpu.md"
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)


@pytest.mark.parametrize("name", ["test_blink", "test_read_from_a_drive"])
def test_examples(name):
    """Every example of the page passes."""
    names = {}
    for example in EXAMPLES:
        exec(compile(example, str(PAGE), "exec"), names)  # noqa: S102 - our own page
    names[name]()


def test_every_code_is_on_the_page():
    """The page names every code that the soft CPU reports."""
    sources = Path(__file__).parents[2].joinpath("plcgen", "cpu").rglob("*.py")
    used = set(re.findall(r'"(PG8[23]\d)"', " ".join(path.read_text("utf-8") for path in sources)))
    assert used == set(re.findall(r"^\| (PG8[23]\d) ", PAGE.read_text("utf-8"), re.MULTILINE))

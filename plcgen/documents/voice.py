"""Languages of a project: which texts a document has for what a source says, and what a source says first.

Templates are English. What the phrase book has is said in every language of the project; the source says it in the
first of them. A comment of the spec is in the language that the spec names, and everything else is English.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any
from weakref import WeakKeyDictionary

from plcgen.documents.phrases import translated
from plcgen.documents.spelling import clean_title, culture, encodable, one_line
from plcgen.project.nouns import Frame

_TITLE = re.compile(r"(\s*TITLE\s*=\s*'?)(.*?)('?)\Z", re.IGNORECASE)
_REGION = re.compile(r"(\s*REGION )(.+)()\Z", re.IGNORECASE)
_COMMENT = re.compile(r"(.*?// )(.+)()\Z")

Texts = tuple[tuple[str, str], ...]
"""Culture and text, in the order of the project's languages."""


class Voice:
    """The languages of one project.

    It remembers the English of what it said in another language, because documents are made from finished sources.
    """

    def __init__(self, frame: Frame) -> None:
        self._target = frame.target
        self.cultures = tuple(dict.fromkeys(map(culture, frame.languages)))
        self.english = next((name for name in self.cultures if name.startswith("en-")), "")
        said = dict(_comments(frame.loaded.spec.model_dump(exclude_none=True)))
        self._said = {text: name for text, name in said.items() if name != self.english and name in self.cultures}
        self._known: dict[str, Texts] = {}
        self._meant: dict[str, str] = {}

    def texts(self, text: str) -> Texts:
        """The text in each language in which there is one; none if the project has no language for it."""
        text = self._meant.get(text, text)
        if text not in self._known:
            self._known[text] = self._texts(text)
        return self._known[text]

    def _texts(self, text: str) -> Texts:
        if not text:
            return ()
        own = self._own(text)
        if own:
            return ((own, text),)
        by_language: Mapping[str, str] = {"en": text, **translated(text)}
        found = ((name, by_language.get(name[:2])) for name in self.cultures)
        return tuple((name, one) for name, one in found if one)

    def _own(self, text: str) -> str:
        """The culture of a comment of the spec inside the text; empty if there is none."""
        words = text.split() if self._said else []
        parts = (" ".join(words[begin:end]) for begin in range(len(words)) for end in range(len(words), begin, -1))
        return next((self._said[part] for part in parts if part in self._said), "")

    def say(self, text: str) -> str:
        """A text as a source has it: in the first language that has it and that its encoding can spell."""
        spoken = next((one for _, one in self.texts(text) if encodable(one, self._target)), text)
        if spoken != text:
            self._meant[spoken] = self._meant.get(text, text)
        return spoken

    def source(self, text: str) -> str:
        """A finished source, its comments, titles and regions said in the project's languages."""
        if self.cultures[0] == self.english:
            return text
        return "\n".join(map(self._spoken, text.split("\n")))

    def _spoken(self, line: str) -> str:
        for pattern, tidy in ((_TITLE, clean_title), (_REGION, str), (_COMMENT, str)):
            match = pattern.match(line)
            if match:
                spoken = tidy(self.say(match[2]))
                if spoken != match[2]:
                    self._meant[spoken] = match[2]
                return f"{match[1]}{spoken}{match[3]}"
        return line


_VOICES: WeakKeyDictionary[Frame, Voice] = WeakKeyDictionary()
"""Made once for each plan and project, kept as long as they are."""


def voice_of(frame: Frame) -> Voice:
    """The languages of a plan or project."""
    if frame not in _VOICES:
        _VOICES[frame] = Voice(frame)
    return _VOICES[frame]


def _comments(tree: Any) -> Iterator[tuple[str, str]]:
    """Every text under a key ``comment``, as sources and titles have it, with its culture."""
    pending = [tree]
    while pending:
        found = pending.pop()
        if isinstance(found, dict):
            comment = found.get("comment")
            if isinstance(comment, dict):
                for language, text in comment.items():
                    line = one_line(str(text))
                    yield line, culture(language)
                    yield " ".join(clean_title(line).split()), culture(language)
            pending += found.values()
        elif isinstance(found, list | tuple):
            pending += found

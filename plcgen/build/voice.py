"""Languages of a project: which texts a document has for what a source says, and what a source says first.

Templates are English. What the phrase book has is said in every language of the project; the source says it in the
first of them. A comment of the spec is in the language that the spec names, and everything else is English.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any
from weakref import WeakKeyDictionary

from plcgen.build.phrases import translated
from plcgen.build.spelling import clean_title, culture, encodable, one_line
from plcgen.project.nouns import Frame

_TITLE = re.compile(r"(\s*TITLE\s*=\s*'?)(.*?)('?)\Z", re.IGNORECASE)
_REGION = re.compile(r"(\s*REGION )(.+)()\Z", re.IGNORECASE)
_COMMENT = re.compile(r"(.*?// )(.+)()\Z")

_PARAMETER = re.compile(r"[rP][0-9]\S*")

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
        self._said = _comments(frame, self.cultures)
        self._known: dict[str, Texts] = {}
        self._meant: dict[str, str] = {}

    def texts(self, text: str) -> Texts:
        """The text in each language in which there is one; none if the project has no language for it."""
        text = "\n".join(self._meant.get(line, line) for line in text.split("\n"))
        if text not in self._known:
            self._known[text] = self._texts(text)
        return self._known[text]

    def _texts(self, text: str) -> Texts:
        """Line by line; of several lines, a comment of the spec is among those of its own language.

        The first language has those of all others, too: its text is that of the source, which has no place for others.
        It has English lines where only some lines are said in it.
        """
        lines = text.split("\n")
        spoken = [(line, self._by_culture(line), len(lines) > 1 and line in self._said) for line in lines]
        first = self.cultures[0]
        mixed = len(lines) > 1 and any(first in said and said[first] == line for line, said, _ in spoken)
        found = {
            name: [
                line if alone else said.get(name, line if mixed and name == first else None)
                for line, said, alone in spoken
                if not alone or name == first or said.get(name) == line
            ]
            for name in self.cultures
        }
        whole = ((name, [one for one in said if one]) for name, said in found.items() if None not in said)
        return tuple((name, "\n".join(said)) for name, said in whole if said)

    def _by_culture(self, line: str) -> Mapping[str, str]:
        """A line in every language that has it: with a comment of the spec in those that the spec has it in."""
        front, part, rest = self._around_comment(line)
        if not part:
            texts: Mapping[str, str] = {"en": line, **translated(line)}
            return {name: texts[name[:2]] for name in self.cultures if name[:2] in texts}
        own = {name: line if one == part else f"{front}{one}{rest}" for name, one in self._said[part].items()}
        return {name: translated(text).get(name[:2], text) if front else text for name, text in own.items()}

    def _around_comment(self, text: str) -> tuple[str, str, str]:
        """What stands before a comment of the spec in the text, the comment, what stands behind it.

        English words are a comment only where one can be: as a whole, behind a parameter or a colon.
        """
        words = text.split() if self._said else []
        for begin, end in ((one, two) for one in range(len(words)) for two in range(len(words), one, -1)):
            part, front, rest = " ".join(words[begin:end]), words[:begin], words[end:]
            comment = self._said.get(part, {})
            if comment and (comment.get(self.english) != part or _stands_alone(front, rest)):
                return "".join(f"{word} " for word in front), part, "".join(f" {word}" for word in rest)
        return "", "", ""

    def say(self, text: str) -> str:
        """A text as a source has it: in the first language that has it and that its encoding can spell.

        A comment of the spec stays as it is.
        """
        if " ".join(text.split()) in self._said:
            return text
        spoken = next((one for _, one in self.texts(text) if encodable(one, self._target)), text)
        if spoken != text:
            self._meant[spoken] = self._meant.get(text, text)
        return spoken

    def line(self, text: str) -> str:
        """The text of a comment as :meth:`source` has it."""
        return text if self.cultures[0] == self.english else self.say(text)

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


def _comments(frame: Frame, cultures: tuple[str, ...]) -> Mapping[str, Mapping[str, str]]:
    """Every comment of the spec, as sources and titles have it, with what the spec says in each culture instead.

    What two comments say otherwise in another language is left out.
    """
    found: dict[str, Mapping[str, str]] = {}
    for comment in _dictionaries(frame.loaded.spec.model_dump(exclude_none=True)):
        lines = {culture(language): one_line(text) for language, text in comment.items()}
        for tidy in (str, clean_title):
            texts = {name: tidy(lines[name]) for name in cultures if lines.get(name)}
            for text in texts.values():
                known = found.setdefault(text, texts)
                found[text] = {name: one for name, one in known.items() if texts.get(name) == one}
    return found


def _dictionaries(tree: Any) -> Iterator[Mapping[str, str]]:
    """Everything under a key ``comment``, by language."""
    pending = [tree]
    while pending:
        found = pending.pop()
        if isinstance(found, dict):
            comment = found.get("comment")
            if isinstance(comment, dict):
                yield comment
            pending += found.values()
        elif isinstance(found, list | tuple):
            pending += found


def _stands_alone(front: list[str], rest: list[str]) -> bool:
    """Whether what is between the words is all there is but for a parameter, a colon, a unit, a drive."""
    begins = not front or front[-1].endswith(":") or _PARAMETER.fullmatch(front[-1]) is not None
    return begins and (not rest or rest[0].startswith(("[", "(")))

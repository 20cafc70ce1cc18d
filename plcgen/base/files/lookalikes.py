"""Letters of different scripts that look alike, and names that only they tell apart.

Cyrillic, Greek and Armenian letters in whose place a reader sees a Latin one. Source of the pairs: Unicode Technical
Standard #39 (Unicode Security Mechanisms), whose term for what a name looks like is skeleton; letters that differ in
usual fonts, such as alpha and a, are left out.
"""

from __future__ import annotations

import re
import unicodedata

_LIKE = {
    "CYRILLIC": "АA ВB СC ЕE НH ІI ЈJ КK МM ОO РP ЅS ТT ХX УY ҮY ԜW ԚQ ԌG ѴV ԀD ЬB ӀI аa сc ԁd еe һh іi јj ӏl оo рp ԛq "
    "ѕs ѵv ԝw хx уy үy гr ѐè ёë ЀÈ ЁË їï ЇÏ",
    "GREEK": "ΑA ΒB ΕE ΖZ ΗH ΙI ΚK ΜM ΝN ΟO ΡP ΤT ΥY ΧX ϹC ϺM ϜF ιi νv οo ρp υu ϲc ϳj",
    "ARMENIAN": "ՕO ՍU ՏS օo ոn սu հh ցg զq յj",
}
_LATIN = {pair[0]: pair[1] for pairs in _LIKE.values() for pair in pairs.split()}
_TABLE = str.maketrans(_LATIN)
_RUN = re.compile(r"[^\W\d_]+")


def skeleton(name: str) -> str:
    """What a name looks like, letter case aside: two names with the same one cannot be told apart."""
    if name.isascii():
        return name.lower()
    return unicodedata.normalize("NFKC", name).translate(_TABLE).lower()


def disguise(name: str) -> str:
    """How a name passes for one in Latin letters; empty if it does not.

    Scripts are mixed within a word, as in the word for copper with a Cyrillic first letter; or beside Latin words
    stands one all of whose letters look like Latin ones. ``cosφ`` and ``Δn`` are names: φ and Δ look like themselves.
    """
    if name.isascii():
        return ""
    words = _RUN.findall(name)
    latin = any(_is_latin(letter) for letter in name)
    for word in words:
        alike = [letter for letter in word if letter in _LATIN]
        if alike and latin and (len(alike) == len(word) or any(map(_is_latin, word))):
            script = next(script for script, pairs in _LIKE.items() if alike[0] in pairs)
            return f"mixes scripts: U+{ord(alike[0]):04X} is {script.title()} and looks like {_LATIN[alike[0]]}"
    return ""


def _is_latin(letter: str) -> bool:
    return (letter.isascii() and letter.isalpha()) or unicodedata.name(letter, "").startswith("LATIN ")

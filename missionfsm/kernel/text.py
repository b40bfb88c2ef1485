"""Texts that come from elsewhere, in a form that can be shown to people."""

from __future__ import annotations

MAX_CHARACTERS = 2000
"""Characters that a line has room for."""

MAX_BRIEF = 60
"""Characters of a value that an error message has room for."""


_WORDS = {None: "null", True: "true", False: "false"}


def brief(value: object) -> str:
    """A value of JSON as an error message shows it: never long."""
    text = _WORDS.get(value) if value is None or isinstance(value, bool) else None
    text = text or repr(value)
    return text if len(text) <= MAX_BRIEF else f"{text[: MAX_BRIEF - 3]}..."


def printable(text: str) -> str:
    """The text without control characters, which a terminal would obey: names come from the network."""
    if text.isprintable():
        return text
    return "".join(character if character.isprintable() else ascii(character)[1:-1] for character in text)


def shortened(text: str, most: int) -> str:
    """The text, or the beginning and the end of one that has more than about so many characters."""
    half = most // 2
    return text if len(text) <= most else f"{text[:half]} … {text[-half:]}"


def differing(one: str, other: str) -> tuple[str, str]:
    """Two texts to be shown side by side: of long ones, the part that differs with a little before and after it."""
    if max(len(one), len(other)) <= 2 * MAX_BRIEF:
        return one, other
    least = min(len(one), len(other))
    first = next((at for at in range(least) if one[at] != other[at]), least)
    last = next((at for at in range(least - first) if one[-1 - at] != other[-1 - at]), least - first)
    begin = max(0, first - MAX_BRIEF // 2)
    both = (text[begin : len(text) - last + min(last, MAX_BRIEF // 2)] for text in (one, other))
    here, there = (f"{'…' if begin else ''}{shortened(text, 4 * MAX_BRIEF)}" for text in both)
    return (f"{here}…", f"{there}…") if last > MAX_BRIEF // 2 else (here, there)


def clipped(text: str) -> str:
    """The text as one line of moderate length without control characters."""
    return printable(shortened(text, MAX_CHARACTERS))


def printable_lines(text: str) -> str:
    """The text without control characters other than line feeds."""
    return "\n".join(map(printable, text.split("\n")))


def counted(number: int, thing: str, things: str = "") -> str:
    """A number of things in words: 1 rule, 2 rules; `things` where the plural is another word."""
    return f"{number} {thing if number == 1 else things or f'{thing}s'}"

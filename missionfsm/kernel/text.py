"""Texts that come from elsewhere, as people are shown them."""

from __future__ import annotations

MAX_CHARACTERS = 2000
"""Characters that a line has room for."""

MAX_BRIEF = 60
"""Characters of a value that an error message has room for."""


def brief(value: object) -> str:
    """A value as an error message shows it: never long."""
    text = repr(value)
    return text if len(text) <= MAX_BRIEF else f"{text[: MAX_BRIEF - 3]}..."


def printable(text: str) -> str:
    """The text without what a terminal would obey: names come from the network."""
    if text.isprintable():
        return text
    return "".join(character if character.isprintable() else ascii(character)[1:-1] for character in text)


def shortened(text: str, most: int) -> str:
    """A text of at most about so many characters: of a longer one the beginning and the end."""
    half = most // 2
    return text if len(text) <= most else f"{text[:half]} … {text[-half:]}"


def clipped(text: str) -> str:
    """A line of moderate length that no terminal obeys; of a long one the beginning and the end."""
    return printable(shortened(text, MAX_CHARACTERS))


def printable_lines(text: str) -> str:
    """A text without what a terminal would obey; its lines stay apart."""
    return "\n".join(map(printable, text.split("\n")))


def counted(number: int, thing: str, things: str = "") -> str:
    """A number of things in words: 1 rule, 2 rules; `things` where the plural is another word."""
    return f"{number} {thing if number == 1 else things or f'{thing}s'}"

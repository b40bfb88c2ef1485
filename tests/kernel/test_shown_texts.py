"""Long texts as people are shown them."""

from __future__ import annotations

from missionfsm.kernel.text import differing, shortened


def test_short_texts_are_shown_whole() -> None:
    """Nothing is left out that there is room for."""
    assert differing("{}", '{"laps": 2}') == ("{}", '{"laps": 2}')
    assert shortened("x" * 10, 10) == "x" * 10


def test_two_long_texts_are_told_apart_by_where_they_differ() -> None:
    """What is the same before and after is left out but for a little of it, and what differs is shown."""
    same = "same " * 100
    one, other = differing(f"{same}apple {same}", f"{same}pear {same}")
    assert ("apple" in one, "pear" in other, "apple" in other) == (True, True, False)
    assert (one[0], one[-1], max(len(one), len(other)) < 100) == ("…", "…", True)
    assert differing(same, f"{same}x")[1].endswith("same x")

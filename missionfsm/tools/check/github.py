"""Verdicts as workflow commands of GitHub Actions, which are shown beside the lines of the files that they name."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from missionfsm.kernel.text import printable_lines
from missionfsm.tools.check.verdict import Outcome, Verdict

_DATA = str.maketrans({"%": "%25", "\r": "%0D", "\n": "%0A"})
_PROPERTY = str.maketrans({"%": "%25", "\r": "%0D", "\n": "%0A", ":": "%3A", ",": "%2C"})


def workflow_commands(verdicts: Iterable[tuple[str | None, str, Verdict]]) -> Iterator[str]:
    """A line for each verdict that is bad (an error), and for each reading that departs from the text (a warning).

    Args:
        verdicts: each with its file, if it is about a file, and with what it is about in words.
    """
    for path, about, verdict in verdicts:
        line = (verdict.violation and verdict.violation.line) or 1
        title = f"{verdict.headline}: {about}"
        if verdict.outcome is not Outcome.CONFORMS:
            text = verdict.violation.explanation if verdict.violation else f"because {verdict.because}"
            yield _command("error", path, line, title, text)
        for flagged in verdict.flagged if verdict.conforms else ():
            yield _command("warning", path, 1, title, flagged)


def _command(kind: str, path: str | None, line: int, title: str, text: str) -> str:
    place = {"file": path, "line": str(line)} if path else {}
    properties = ",".join(
        f"{name}={printable_lines(value).translate(_PROPERTY)}" for name, value in {**place, "title": title}.items()
    )
    return f"::{kind} {properties}::{printable_lines(text).translate(_DATA)}"


__all__ = ["workflow_commands"]

"""What a package index shows: the README, and the links beside it.

The repository's address is no part of it. Whoever publishes says it, `MISSIONFSM_REPOSITORY=https://… python -m build`:
then the README's links and its picture lead there. Without it they would lead nowhere, so that of links the text is
left, and of the picture nothing (the second example shows the same in words).
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface

COMMENT = re.compile(r"<!-- [^>]* -->\n")
PICTURE = re.compile(r"!\[([^\]]*)\]\((?!https?:)([^)]*)\)\n+")
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\((?!https?:)([^)]*)\)")


def shown(readme: str, repository: str) -> str:
    """The README as an index shows it, with the address of the repository or with an empty text."""
    text = COMMENT.sub("", readme)
    text = PICTURE.sub(rf"![\1]({repository}/raw/HEAD/\2)\n\n" if repository else "", text)
    return LINK.sub(rf"[\1]({repository}/blob/HEAD/\2)" if repository else r"\1", text)


def urls(repository: str) -> dict[str, str]:
    """The links beside it."""
    places = {"Documentation": "docs/tutorial.md", "Changelog": "CHANGELOG.md"}
    pages = {name: f"{repository}/blob/HEAD/{path}" for name, path in places.items()}
    return {"Repository": repository, "Issues": f"{repository}/issues", **pages} if repository else {}


class Hook(MetadataHookInterface):
    """Fills in what pyproject.toml calls dynamic."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Add the README and the links."""
        repository = os.environ.get("MISSIONFSM_REPOSITORY", "").rstrip("/")
        text = shown((Path(self.root) / "README.md").read_text(encoding="utf-8"), repository)
        metadata["readme"] = {"content-type": "text/markdown", "text": text}
        metadata["urls"] = urls(repository)

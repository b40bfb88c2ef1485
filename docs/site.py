"""A hook of MkDocs: the site has the layout of the repository, so that a link that holds in one holds in the other.

The page on the Python names, ``docs/api.md``, is written here from `missionfsm.__all__`; all else lies there as it is.
"""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

import missionfsm

ROOT = Path(__file__).parent.parent
TAKEN = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "LICENSE", "docs", "specs", "diagrams", "examples")
_PARTS = {
    "Judging": ("check", "check_robots", "conform", "explore", "Verdict", "Outcome", "UnreadableError", "SubjectError"),
    "A fake robot and a fake fleet": ("Robot", "Fleet", "Shared", "serve", "missions", "workflows"),
    "Messages": ("State", "Command", "Goal", "Pose", "to_json", "from_json"),
    "Errors": ("ApiError", "DeadlineExceeded", "FailedPrecondition", "Internal", "InvalidArgument", "NotFound"),
    "Isaac's mission server": ("MissionServer", "Mission"),
    "Systems": ("systems",),
}


def api() -> str:
    """The page on every public name, by what it is for."""
    told = {name for names in _PARTS.values() for name in names}
    assert told == set(missionfsm.__all__) - {"__version__"}, told ^ set(missionfsm.__all__)
    lines = ["# Python", "", "All names are imported from `missionfsm` itself.", ""]
    for part, names in _PARTS.items():
        lines += [f"## {part}", ""]
        for name in names:
            lines += [f"::: {_place(name)}", "    options: {heading_level: 3}", ""]
    return "\n".join(lines)


def _place(name: str) -> str:
    """Where a public name is defined."""
    thing = getattr(missionfsm, name)
    return thing.__name__ if isinstance(thing, ModuleType) else f"{thing.__module__}.{thing.__qualname__}"


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Take the files of the repository in the place of those in docs_dir; those of the theme stay."""
    theme = [file for file in files if file.src_dir != config.docs_dir]
    found = [path for name in TAKEN for path in _below(ROOT / name)]
    ours = [File.generated(config, str(path.relative_to(ROOT)), abs_src_path=str(path)) for path in found]
    return Files([*theme, *ours, File.generated(config, "docs/api.md", content=api())])


def _below(path: Path) -> list[Path]:
    if path.is_file():
        return [path]
    return sorted(one for one in path.rglob("*") if one.is_file() and not _hidden(one))


def _hidden(path: Path) -> bool:
    return any(part.startswith((".", "__")) for part in path.relative_to(ROOT).parts)

"""The register of variants: choices that the page leaves open, and bugs that contradict it."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

from service import Robot


@dataclass(frozen=True)
class Variant:
    """A robot that differs from the base in one respect."""

    name: str
    sentence: str
    place: str
    robot: type[Robot]


PAGE = "Mission"

CHOICES: dict[str, Variant] = {}
BUGS: dict[str, Variant] = {}


def kebab(class_name: str) -> str:
    """The name of a variant, made from the name of its class."""
    return re.sub(r"(?<!^)(?=[A-Z])", "-", class_name.strip("_")).lower()


def _registrar(register: dict[str, Variant], place: str) -> Callable[[type[Robot]], type[Robot]]:
    def enter(robot: type[Robot]) -> type[Robot]:
        name = kebab(robot.__name__)
        if name in CHOICES or name in BUGS:
            raise ValueError(f"{name} is declared twice")
        register[name] = Variant(name, " ".join((robot.__doc__ or "").split()), f"{PAGE} › {place}", robot)
        return robot

    return enter


def choice(place: str) -> Callable[[type[Robot]], type[Robot]]:
    """Declare a legitimate variant. Its name comes from the class, its sentence from the docstring."""
    return _registrar(CHOICES, place)


def bug(place: str) -> Callable[[type[Robot]], type[Robot]]:
    """Declare a fault. Its name comes from the class, its sentence from the docstring."""
    return _registrar(BUGS, place)

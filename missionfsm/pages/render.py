"""From values and a template to one self-contained page: styles and scripts stand in it, and nothing is fetched."""

from __future__ import annotations

import functools
from importlib import resources

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape


@functools.cache
def _environment() -> Environment:
    # Whatever an implementation sent ends up in a page, so everything is escaped.
    environment = Environment(
        loader=PackageLoader("missionfsm.pages"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.policies["json.dumps_kwargs"] = {"separators": (",", ":"), "sort_keys": False}
    environment.filters["prose"] = prose
    return environment


def rendered(template: str, **values: object) -> str:
    """The page that a template makes of some values."""
    return _environment().get_template(template).render(**values)


def prose(text: str) -> Markup:
    """Text whose parts between backticks are code, as in the written specifications."""
    parts = text.split("`")
    if len(parts) % 2 == 0:  # a backtick without its partner is just that
        return escape(text)
    return Markup("").join(
        Markup("<code>{}</code>").format(part) if number % 2 else escape(part) for number, part in enumerate(parts)
    )


def specification_page(system: str) -> str:
    """The written specification of a system; empty for a system that has none."""
    page = resources.files("missionfsm.pages").joinpath("specs", system.replace(".", "-") + ".md")
    return page.read_text(encoding="utf-8") if page.is_file() else ""

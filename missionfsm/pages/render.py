"""From values and a template to one self-contained page: styles and scripts stand in it, and nothing is fetched."""

from __future__ import annotations

import functools
import re
from importlib import resources

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

_MARKED = re.compile(r"`(?P<code>[^`]+)`|\*(?P<stressed>[^*\s](?:[^*]*[^*\s])?)\*")


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
    """Text of the written specifications: what stands between backticks is code, between asterisks emphasis."""
    found = Markup("")
    end = 0
    for match in _MARKED.finditer(text):
        element = Markup("<code>{}</code>") if match["code"] else Markup("<em>{}</em>")
        found += escape(text[end : match.start()]) + element.format(match["code"] or match["stressed"])
        end = match.end()
    return found + escape(text[end:])


def specification_page(system: str) -> str:
    """The written specification of a system; empty for a system that has none."""
    page = resources.files("missionfsm.pages").joinpath("specs", system.replace(".", "-") + ".md")
    return page.read_text(encoding="utf-8") if page.is_file() else ""

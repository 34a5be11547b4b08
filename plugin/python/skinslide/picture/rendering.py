"""The templates of pages, and what they may call."""

from __future__ import annotations

import base64
import hashlib
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from skinslide.picture.embedded import film, others, uri
from skinslide.picture.plots import charts
from skinslide.shot.report import milliseconds_text, roughness_text, stretch_text, time_text


def render(name: str, **values: Any) -> str:
    """A page of a template, with the style of all pages and a script of its own name."""
    templates = _templates()
    style, script = _inlined(templates, "page.css"), _inlined(templates, name.replace(".html", ".js"))
    return templates.get_template(name).render(style=style, script=script, **values)


def _templates() -> Environment:
    """All that the templates are given is escaped text, except for the page's own style and script."""
    templates = Environment(
        loader=PackageLoader("skinslide.picture"),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=_shown,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    templates.policies["json.dumps_kwargs"] = {"separators": (",", ":"), "allow_nan": False}
    templates.globals["charts_of"] = charts
    templates.globals.update(film_of=film, others=others)
    templates.filters.update(
        change=_change,
        changed=_changed,
        digest=_digest,
        milliseconds=milliseconds_text,
        moment=_moment,
        path=_path,
        roughness=roughness_text,
        stretch=stretch_text,
        time=time_text,
        units=lambda number: f"{number:.2f}",
        uri=uri,
    )
    return templates


def _inlined(templates: Environment, name: str) -> Markup:
    """The text of a file beside the templates, such as the style."""
    loader = templates.loader
    assert loader
    return Markup(loader.get_source(templates, name)[0])


def _shown(value: Any) -> Any:
    """Text in which bytes of file names that are not UTF-8 are shown as numbers."""
    plain = isinstance(value, str) and not isinstance(value, Markup)
    return value.encode("utf-8", "backslashreplace").decode() if plain else value


def _path(prim: str) -> Markup:
    """A prim's path, which may be broken after a slash."""
    return Markup("/<wbr>").join(map(_shown, prim.split("/")))


def _digest(inlined: str) -> str:
    """The digest by which a content security policy names a style or a script."""
    return f"sha256-{base64.b64encode(hashlib.sha256(inlined.encode()).digest()).decode()}"


def _moment(frame: float | None) -> str:
    return "default value" if frame is None else f"frame {time_text(frame)}"


def _change(change: float | None) -> str:
    return "" if change is None else f"{100 * change:+.0f} %".replace("-", "\N{MINUS SIGN}")


def _changed(after: float, before: float) -> str:
    return _change(after / before - 1 if before > 0 else None)

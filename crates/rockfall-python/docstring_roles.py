"""An extension of mkdocstrings: turns the roles of docstrings, such as :class:`Scene`, into links. scripts/python-docs uses it.

Names of the package and of members with their class become links, which are checked; members of the same class become code.
"""

from __future__ import annotations

import re
from typing import Any

import griffe

_ROLE = re.compile(r":(class|meth|attr|func):`([\w.]+)`")


def _link(found: re.Match[str]) -> str:
    role, name = found.groups()
    return f"[`{name}`][rockfall.{name}]" if name[0].isupper() or role == "func" else f"`{name}`"


class Roles(griffe.Extension):
    """Replaces roles when an object has been read."""

    def on_object(self, *, obj: griffe.Object, **_: Any) -> None:
        """Changes the docstring of an object."""
        if obj.docstring is not None:
            obj.docstring.value = _ROLE.sub(_link, obj.docstring.value)

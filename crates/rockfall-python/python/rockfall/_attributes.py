"""Attributes that do not exist are errors that name similar ones."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

#: Number of similar names in a message.
_MOST = 3
#: Similarity of names in a message, from 0 to 1.
_LEAST = 0.6


def near(name: str, known: Iterable[str]) -> list[str]:
    """The known names that are similar to a name or contain it, the most similar first."""
    word = name.lower()
    similarity = {}
    for other in known:
        plain = other.rpartition(".")[2]
        ratio = difflib.SequenceMatcher(None, word, plain).ratio()
        is_part = len(word) > 3 and word in plain
        similarity[other] = max(ratio, _LEAST) if is_part else ratio
    close = [other for other in similarity if similarity[other] >= _LEAST]
    return sorted(close, key=lambda other: -similarity[other])[:_MOST]


def hint(name: str, known: Iterable[str]) -> str:
    """The end of a message about an unknown name: similar names, or all of them if there are none."""
    names = list(known)
    found = near(name, names)
    return f"did you mean {' or '.join(found)}?" if found else f"expected one of {', '.join(names)}"


def _unknown(owner: Any, name: str) -> AttributeError:
    cls = type(owner)
    members = [member for member in dir(cls) if not member.startswith("_")]
    found = near(name, [*members, *owner._further_names()])
    end = f"did you mean {' or '.join(found)}?" if found else f"help(rockfall.{cls.__name__}) describes those that it has"
    text = f"a {cls.__name__} has no attribute {name!r}: {end}"
    # With a name and without an object, Python adds no guess of its own.
    return AttributeError(text, name=name)


class Strict:
    """Refuses attributes that a class does not have. Classes that are derived outside of the package may have others."""

    __slots__ = ()

    def _further_names(self) -> Iterable[str]:
        """Names that a message may propose besides those of the attributes."""
        return ()

    # Type checkers would otherwise accept every attribute.
    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            if name.startswith("_") or hasattr(type(self), name):
                # The error of a property, too, is raised as it is.
                return object.__getattribute__(self, name)
            raise _unknown(self, name)

        def __setattr__(self, name: str, value: Any) -> None:
            cls = type(self)
            if not name.startswith("_") and cls.__module__.partition(".")[0] == "rockfall":
                known = getattr(cls, name, None)
                if known is None:
                    raise _unknown(self, name)
                if callable(known) and not callable(value):
                    raise AttributeError(f"{name} is a method of {cls.__name__}, which cannot be set", name=name)
            object.__setattr__(self, name, value)

"""Attributes and keyword arguments that do not exist are errors that name similar ones."""

from __future__ import annotations

import difflib
import functools
import inspect
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any, TypeVar

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


_Call = TypeVar("_Call", bound=Callable[..., Any])


def keywords(function: _Call) -> _Call:
    """The function, whose errors of unknown keyword arguments name similar ones. One that passes on all of them stays as it is."""
    parameters = inspect.signature(function).parameters.values()
    kinds = {parameter.kind for parameter in parameters}
    if inspect.Parameter.KEYWORD_ONLY not in kinds or inspect.Parameter.VAR_KEYWORD in kinds:
        return function
    known = frozenset(parameter.name for parameter in parameters if parameter.name != "self")

    @functools.wraps(function)
    def checked(*args: Any, **options: Any) -> Any:
        if not known.issuperset(options):
            wrong = next(name for name in options if name not in known)
            found = near(wrong, sorted(known))
            end = f": did you mean {' or '.join(found)}?" if found else ""
            # Users know the class of the object, and not the base that has the method.
            owner = f"{type(args[0]).__name__}." if args and "." in function.__qualname__ else ""
            raise TypeError(f"{owner}{function.__name__}() got an unexpected keyword argument {wrong!r}{end}")
        return function(*args, **options)

    same: Any = checked
    return same  # type: ignore[no-any-return]


class Strict:
    """Refuses attributes and keyword arguments that a class does not have. Classes that are derived outside of the package may have others."""

    __slots__ = ()

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        for owner in cls.__mro__:
            if owner.__module__.partition(".")[0] != "rockfall":
                continue
            for name, member in list(vars(owner).items()):
                is_call = inspect.isfunction(member) and (name == "__init__" or not name.startswith("_"))
                if is_call and not hasattr(member, "__wrapped__"):
                    setattr(owner, name, keywords(member))

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

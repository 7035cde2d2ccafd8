"""Names, colours, labels and looks of objects."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from rockfall import _rockfall
from rockfall._arrays import IntArray, integers
from rockfall.typing import LookName, TaggedName

_KINDS = ("sphere", "rod", "capsule", "spring", "box", "polygon")


class Tag(NamedTuple):
    """What an object is called and how it is drawn, as :meth:`Objects.tag` returns it. None stands for none."""

    #: Name; several objects may have the same.
    name: str | None = None
    #: Colour: a name such as ``red``, or ``#`` and six hexadecimal digits.
    colour: str | None = None
    #: Text beside the object in pictures with labels.
    label: str | None = None
    #: How its surface is drawn: plain, striped, wood, stone or glass.
    look: LookName | None = None


class Named(NamedTuple):
    """Numbers of the objects with a name, as ``scene["left"]`` returns them. The spheres and rods of capsules are among them."""

    #: Numbers of the spheres.
    spheres: IntArray
    #: Numbers of the rods.
    rods: IntArray
    #: Numbers of the capsules.
    capsules: IntArray
    #: Numbers of the springs.
    springs: IntArray
    #: Numbers of the boxes.
    boxes: IntArray
    #: Numbers of the polygons.
    polygons: IntArray


class Names:
    """Finds objects by their names. A base of :class:`Objects`."""

    _native: Any

    # Otherwise Python would count through the numbers from 0.
    __iter__ = None

    @property
    def names(self) -> list[str]:
        """The names of objects, each once, in alphabetical order."""
        return _rockfall.names(self._native)

    def __getitem__(self, name: str) -> Named:
        """The objects with a name.

        Raises
        ------
        KeyError
            When no object has it.
        """
        if not isinstance(name, str):
            raise TypeError(f"expected the name of objects, got {type(name).__name__}")
        return Named(*(np.array(numbers, dtype=np.int64) for numbers in _rockfall.named(self._native, name)))

    def __contains__(self, name: object) -> bool:
        return name in self.names

    def tag(self, kind: TaggedName, id: int) -> Tag:
        """The name, colour, label and look of an object.

        Parameters
        ----------
        kind : str
            sphere, rod, capsule, spring, box or polygon.
        id : int
            Number of the object.

        Raises
        ------
        ValueError
            For an unknown kind.
        LookupError
            For an object that does not exist.
        """
        _check_kind(kind)
        return Tag(*_rockfall.tag(self._native, kind, id))

    def set_tag(
        self,
        kind: TaggedName,
        ids: npt.ArrayLike,
        *,
        name: str | None = None,
        colour: str | None = None,
        label: str | None = None,
        look: LookName | None = None,
    ) -> None:
        """Replace the name, colour, label and look of objects. Those of a capsule also hold for its spheres and its rod.

        Parameters
        ----------
        kind : str
            sphere, rod, capsule, spring, box or polygon.
        ids : array_like of int, shape (N,) or ()
            Numbers of the objects.
        name : str, optional
            A word that begins with a letter or ``_``, without ``=``, ``,`` and ``#``.
        colour : str, optional
            Colour in pictures: a name such as ``red``, or six hexadecimal digits such as ``#ff8800``.
        label : str, optional
            A line of text for pictures with labels.
        look : str, optional
            How surfaces are drawn: plain, striped, wood, stone or glass; the usual look of their kind by default.

        Raises
        ------
        ValueError
            For an unknown kind, a name or a label that is not allowed, or an unknown colour or look. Nothing is changed then.
        LookupError
            For an object that does not exist. Nothing is changed then.
        """
        _check_kind(kind)
        numbers = integers("ids", ids)
        _rockfall.set_tags(self._native, kind, numbers, tag_of(name, colour, label, look))


def tag_of(name: str | None, colour: str | None, label: str | None, look: LookName | None) -> Tag:
    """A tag that was checked."""
    tag = Tag(name, colour, label, look)
    for field, value in tag._asdict().items():
        if value is not None and not isinstance(value, str):
            raise TypeError(f"{field}: expected a str, got {type(value).__name__}")
    _rockfall.check_tag(tag)
    return tag


def _check_kind(kind: str) -> None:
    if kind not in _KINDS:
        raise ValueError(f"kind: expected one of {', '.join(_KINDS)}, got {kind!r}")

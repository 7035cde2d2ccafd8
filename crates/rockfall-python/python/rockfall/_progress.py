"""Progress bars."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Any


class Progress:
    """A progress bar on standard error, by tqdm where it is installed. Without a total, it shows nothing."""

    def __init__(self, total: int | None, unit: str = "step") -> None:
        self._total = total
        self._unit = unit
        self._done = 0
        self._note = ""
        self._shown = 0.0
        self._bar: Any = None
        if total is not None:
            try:
                from tqdm.auto import tqdm
            except ImportError:
                return
            self._bar = tqdm(total=total, unit=unit)

    def advance(self, steps: int) -> None:
        """Count steps."""
        self._done += steps
        if self._bar is not None:
            self._bar.update(steps)
        elif self._total is not None and (self._done == self._total or time.monotonic() - self._shown > 0.2):
            self._shown = time.monotonic()
            note = f", {self._note}" if self._note else ""
            print(f"\r{self._done} of {self._total} {self._unit}s{note}", end="", file=sys.stderr, flush=True)

    def note(self, text: str) -> None:
        """Show a text next to the bar. Without tqdm, it is shown with the next count."""
        self._note = text
        if self._bar is not None:
            self._bar.set_postfix_str(text)

    def __enter__(self) -> Progress:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bar is not None:
            self._bar.close()
        elif self._done and self._total is not None:
            print(file=sys.stderr)

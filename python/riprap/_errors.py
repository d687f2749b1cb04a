"""Exceptions."""

from __future__ import annotations

from typing import Iterable, NamedTuple


class Problem(NamedTuple):
    """A fault or doubtful point of a scene, with its place in the text."""

    line: int
    """Line, from 1."""
    column: int
    """Column, from 1."""
    severity: str
    """`error` or `warning`."""
    message: str
    """Value found and values allowed."""
    code: str
    """Cause, as `riprap explain CODE` tells."""


class SceneError(ValueError):
    """A scene that cannot run; `problems` has every fault with its line and column."""

    problems: list[Problem]

    def __init__(self, message: str, problems: Iterable[tuple[int, int, str, str, str]] = ()) -> None:
        super().__init__(message)
        self.problems = [Problem(*problem) for problem in problems]

    def __reduce__(self) -> tuple[type[SceneError], tuple[str, list[Problem]]]:
        return type(self), (str(self), self.problems)


class RunError(RuntimeError):
    """A run that failed; the message names what failed, when, and what to change."""

    code: str
    """Cause, as `riprap explain CODE` tells; empty where there is none."""

    def __init__(self, message: str, code: str = "") -> None:
        super().__init__(message)
        self.code = code

    def __reduce__(self) -> tuple[type[RunError], tuple[str, str]]:
        return type(self), (str(self), self.code)

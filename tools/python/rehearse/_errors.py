"""Errors of the module: each has the diagnostics that the command prints."""

from __future__ import annotations

import errno
import os
from dataclasses import dataclass
from typing import Iterable, Tuple


@dataclass(frozen=True)
class Diagnostic:
    """One finding about a file or an argument. ``line`` and ``column`` count from 1; 0: unknown."""

    severity: str
    file: str
    line: int
    column: int
    message: str
    hint: str

    def __str__(self) -> str:
        place = ":".join([self.file] + [str(n) for n in (self.line, self.column) if n]) if self.file else ""
        return f"{place}{': ' if place else ''}{self.severity}: {self.message}{f' ({self.hint})' if self.hint else ''}"


class Error(Exception):
    """Bad input, or a run that can't begin. ``diagnostics`` has all findings.

    ``file``, ``line``, ``column``, ``message`` and ``hint`` are those of the first finding.
    """

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics: Tuple[Diagnostic, ...] = tuple(diagnostics)
        super().__init__("\n".join(map(str, self.diagnostics)))

    @classmethod
    def of(cls, findings: Iterable[tuple]) -> "Error":
        return cls(Diagnostic(*finding) for finding in findings)

    @classmethod
    def saying(cls, message: str, hint: str = "", file: str = "") -> "Error":
        return cls([Diagnostic("error", file, 0, 0, message, hint)])

    def __str__(self) -> str:
        return self.args[0]

    @property
    def file(self) -> str:
        return self.diagnostics[0].file

    @property
    def line(self) -> int:
        return self.diagnostics[0].line

    @property
    def column(self) -> int:
        return self.diagnostics[0].column

    @property
    def message(self) -> str:
        return self.diagnostics[0].message

    @property
    def hint(self) -> str:
        return self.diagnostics[0].hint


class UnknownName(Error, KeyError):
    """A series, a controller or a camera that the recording doesn't have; ``hint`` has similar names."""


class NoSuchFile(Error, FileNotFoundError):
    """A file that isn't there."""

    @classmethod
    def named(cls, file: str) -> "NoSuchFile":
        return cls([Diagnostic("error", file, 0, 0, os.strerror(errno.ENOENT), "")])

"""How far a job is that runs in a process of its own: one line of its output."""

from base64 import b64decode, b64encode
from dataclasses import dataclass
from typing import TypeVar

import msgspec

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class JobStep:
    """One line of a job's output."""

    what: str
    share: float
    """0..1 of the work is done."""
    result: bytes | None = None
    """With the last line, when it is not refused by error: what was found, in msgpack."""
    error: str = ""
    """With the last line, when the input cannot be used at all."""

    @staticmethod
    def of(result: object) -> "JobStep":
        """The last line of a job that found something."""
        return JobStep("done", 1.0, msgspec.msgpack.encode(result))

    def found(self, form: type[T]) -> T | None:
        """The result; None without one."""
        return None if self.result is None else msgspec.msgpack.decode(self.result, type=form)

    def encode(self) -> bytes:
        """One line. Not JSON: what could not be measured is not a number."""
        return b64encode(msgspec.msgpack.encode(self)) + b"\n"

    @staticmethod
    def decode(line: bytes) -> "JobStep":
        """From a line. Raises ValueError."""
        return msgspec.msgpack.decode(b64decode(line, validate=False), type=JobStep)

"""The error family.

::

    PslvError                 everything we raise on purpose; the command line prints it and exits with 2
    +-- SettingsError         a configuration file, variable or option is wrong
    +-- SourceError           a camera, picture or video cannot be read, or is not what the venue expects
    +-- ServiceError          the service cannot start: port in use, no shared memory
    +-- ConnectionRefused     the server refused a client's ``init``, or did not answer

A message says what was asked, what was found and what would be accepted. What it quotes from a file or a command line
may be of any length, so asked and found are cut at MAX_QUOTED characters each.
The wire never raises: garbage from the network gives ``None`` (see ``vision_core.protocol``).
"""

MAX_QUOTED = 200
MAX_ACCEPTED = 1000
"""Longest lists of accepted values [characters]: the names of a file's own color classes may be among them."""
TAIL = 60
"""Characters kept of the end of a text that is cut: of a long path the end says the most."""


class PslvError(Exception):
    """Base of all errors that PSLV raises on purpose.

    An error with nothing found and nothing accepted is a whole sentence (perhaps another error's) and stays as it is.
    """

    def __init__(self, asked: str, *, found: str = "", accepted: str = "") -> None:
        self.asked = cut(asked) if found or accepted else asked
        self.found = cut(found)
        self.accepted = cut(accepted, MAX_ACCEPTED)
        parts = [self.asked]
        if found:
            parts.append(f"found: {self.found}")
        if accepted:
            parts.append(f"accepted: {self.accepted}")
        super().__init__("; ".join(parts))


class SettingsError(PslvError):
    """A configuration file, environment variable or option is wrong."""


class SourceError(PslvError):
    """A camera, picture or video cannot be read, or is not what the venue expects."""


class ServiceError(PslvError):
    """The service cannot start."""


class ConnectionRefused(PslvError):
    """The server refused a client's ``init``, or did not answer."""

    def __init__(self, asked: str, *, found: str = "", accepted: str = "", code: str = "") -> None:
        """code: the error's name on the wire; empty: there was no answer, or no error."""
        super().__init__(asked, found=found, accepted=accepted)
        self.code = code


def cut(text: str, length: int = MAX_QUOTED) -> str:
    """A text of at most so many characters: its middle is left out when it is longer."""
    return text if len(text) <= length else f"{text[: length - TAIL - 5]} ... {text[-TAIL:]}"

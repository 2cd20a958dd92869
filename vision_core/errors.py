"""The error family.

::

    PslvError                 everything we raise on purpose; the command line prints it and exits with 2
    +-- SettingsError         a configuration file, variable or option is wrong
    +-- SourceError           a camera, picture or video cannot be read, or is not what the venue expects
    +-- ServiceError          the service cannot start: port in use, no shared memory
    +-- ConnectionRefused     the server refused a client's ``init``, or did not answer

A message says what was asked, what was found and what would be accepted.
The wire never raises: garbage from the network gives ``None`` (see ``vision_core.protocol``).
"""


class PslvError(Exception):
    """Base of all errors that PSLV raises on purpose."""

    def __init__(self, asked: str, *, found: str = "", accepted: str = "") -> None:
        self.asked = asked
        self.found = found
        self.accepted = accepted
        parts = [asked]
        if found:
            parts.append(f"found: {found}")
        if accepted:
            parts.append(f"accepted: {accepted}")
        super().__init__("; ".join(parts))


class SettingsError(PslvError):
    """A configuration file, environment variable or option is wrong."""


class SourceError(PslvError):
    """A camera, picture or video cannot be read, or is not what the venue expects."""


class ServiceError(PslvError):
    """The service cannot start."""


class ConnectionRefused(PslvError):
    """The server refused a client's ``init``, or did not answer."""

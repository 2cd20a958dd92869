"""Short process beside a running service: would the service start again?

It reads the files and what was changed on the page, tries what the tasks make of it, and compiles what is missing,
while the service goes on. The last line on standard output says how far it is, or why not; then the exit status is 2.
"""

import os
import sys

import msgspec

from app.launch.plan import layers_without_text
from app.launch.preflight import try_settings
from app.launch.prepared import StartOptions, prepare
from app.launch.sockets import ADDRESSES
from vision_core.errors import PslvError, ServiceError
from vision_core.scheduling.attachment import end_with
from vision_core.settings.schema import ServerSettings, Settings
from vision_core.startup.compile import compile_kernels

NICENESS = "19"
"""The running service comes first."""


class Running(msgspec.Struct, frozen=True):
    """How the running service was started."""

    start: StartOptions
    server: ServerSettings
    source: str
    """Address of its source, which it has open."""


def check_command(running: Running) -> tuple[str, ...]:
    """The command that runs this check."""
    return ("nice", "-n", NICENESS, sys.executable, "-m", __name__, msgspec.json.encode(running).decode())


def check(running: Running) -> None:
    """Raise PslvError with one line for a person when a restart would fail."""
    prepared = prepare(running.start, _say)
    layers_without_text(prepared)
    _check_addresses(prepared.settings, running.server)
    _say("trying what the tasks make of the settings")
    try_settings(prepared.settings, opens_source=prepared.settings.source.uri != running.source)
    compile_kernels(prepared.settings, show=_say, log=_say, go_on=lambda: True)


def _check_addresses(settings: Settings, running: ServerSettings) -> None:
    """A restart goes on with the sockets of the service, so their addresses must not have changed."""
    for name in ADDRESSES:
        found, accepted = getattr(settings.server, name), getattr(running, name)
        if found != accepted:
            raise ServiceError(
                f"server.{name}",
                found=str(found),
                accepted=f"{accepted} as long as the service runs; another one needs a stop and a start",
            )


def _say(line: str) -> None:
    print(line, flush=True)


def main() -> int:
    """Check; the argument says how the running service was started."""
    end_with(os.getppid())
    try:
        check(msgspec.json.decode(sys.argv[1], type=Running))
    except PslvError as error:
        _say(str(error))
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())

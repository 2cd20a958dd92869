"""Before a service starts: can the tasks work with the settings, and how well does this machine keep time?

Each is tried in a process of its own, so that nothing is half started when it fails.
"""

import contextlib
import subprocess
import sys
from collections.abc import Callable

import msgspec

from app.launch.resource_owners import device_holder
from vision_core.capture.devices import device_path
from vision_core.errors import PslvError, SourceError
from vision_core.rtdb.infos import SelfTest
from vision_core.scheduling import selftest
from vision_core.settings.schema import Settings
from vision_core.startup import PREFLIGHT, WITHOUT_SOURCE


def preflight(settings: Settings, log: Callable[[str], None]) -> SelfTest:
    """Open the source once and measure how well the machine keeps time, both at once. Returns the measurement.

    log: takes one line of what a person should know about the source.

    Raises PslvError with one line for a person when the service could not work.
    """
    command = [sys.executable, "-m", selftest.__name__]
    with subprocess.Popen(command, stdout=subprocess.PIPE, process_group=0) as timing, contextlib.ExitStack() as held:
        held.callback(timing.kill)
        for line in try_settings(settings):
            log(line)
        measured = timing.communicate()[0]
        if timing.returncode:
            raise PslvError(
                "self-test of the machine", found=f"exit status {timing.returncode}", accepted="pslv selftest"
            )
        return msgspec.json.decode(measured, type=SelfTest)


def try_settings(settings: Settings, *, opens_source: bool = True) -> list[str]:
    """Let a process make what the tasks make of the settings. Returns its remarks; raises PslvError when it fails.

    opens_source: it also opens the source and closes it; not one that a running service has open.
    """
    arguments = [] if opens_source else [WITHOUT_SOURCE]
    tried = subprocess.run(
        [sys.executable, "-m", PREFLIGHT, *arguments],
        input=msgspec.json.encode(settings),
        capture_output=True,
        check=False,
    )
    lines = tried.stderr.decode(errors="replace").strip().splitlines()
    if tried.returncode:
        lines = lines or ["no message"]
        raise PslvError((lines[-1] if tried.returncode == 2 else "\n".join(lines)) + _in_use_by(settings))
    return lines


def _in_use_by(settings: Settings) -> str:
    """The program that has the camera open already; empty when none is known."""
    device = settings.source.device
    holder = None
    if device is not None:
        with contextlib.suppress(SourceError):
            holder = device_holder(device_path(device))
    return f"; {holder} has it open" if holder else ""

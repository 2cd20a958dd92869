"""Makes the support bundle: a zip of files that a person can read.

A new file needs its line in FILES. Everything but the picture goes through ``redaction.without_secrets``.
"""

import io
import json
import time
import zipfile
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from msgspec import to_builtins

from app.web.blackboard import Blackboard, Picture, ServiceSnapshot, Timings
from app.web.health.monitor import Health
from app.web.reports.base import Report
from app.web.reports.changes import change_from
from app.web.reports.checks import checks_from
from app.web.reports.log import log_from
from app.web.reports.machine import machine_from
from app.web.reports.processes import processes_from
from app.web.reports.status import status_from
from app.web.reports.tasks import tasks_from
from app.web.reports.timing import timing_from
from app.web.storage.document import Change
from app.web.support.redaction import TAKEN_OUT, without_secrets
from app.web.support.versions import versions_of
from vision_core.native.opencv import encode_jpeg
from vision_core.rtdb import records
from vision_core.rtdb.log_record import ServiceLog

CHANGES = 200
"""The newest changes that are in the bundle."""
PICTURE, PICTURE_QUALITY = "snapshot.jpg", 92
SINCE_START = "they count since the start of each process: the service keeps none of the last minute alone"
README = """Support bundle of PSLV {version}, made {made}.

{files}

Not in it: passwords, tokens, keys, and the contacts of teams; "{taken_out}" stands in their place, and in place of
what looks like one of them or like an e-mail address.
In it: names of teams, network addresses of programs, names of files, and whatever the camera sees. Look into it before
you send it.
"""


@dataclass(frozen=True, slots=True)
class Gathered:
    """What the files are made of."""

    snapshot: ServiceSnapshot
    health: Health
    timings: Timings
    log: ServiceLog
    changes: Sequence[Change]
    """The newest first."""
    picture: Picture | None


def gathered(blackboard: Blackboard, health: Health, changes: Sequence[Change]) -> Gathered:
    """Everything at this instant. health: as it was judged over some time."""
    return Gathered(
        blackboard.read(), health, blackboard.timings(), blackboard.log(), changes[:CHANGES], blackboard.picture()
    )


def bundle_name() -> str:
    """Name of a bundle that is made now."""
    return f"pslv-support-{time.strftime('%Y%m%d-%H%M%S')}.zip"


def bundle_of(source: Gathered) -> bytes:
    """The zip."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("README.txt", _readme(source))
        for name, _, make in FILES:
            content = without_secrets(make(source))
            archive.writestr(name, content if isinstance(content, str) else _json(content))
        if source.picture is not None:
            archive.writestr(PICTURE, encode_jpeg(source.picture.pixels, PICTURE_QUALITY))
    return packed.getvalue()


def _readme(source: Gathered) -> str:
    picture = "the newest picture of the camera" if source.picture else "is missing: no picture has come yet"
    words = {name: words for name, words, _ in FILES} | {PICTURE: picture}
    files = "\n".join(f"{name:15} {text}" for name, text in words.items())
    made = time.strftime("%Y-%m-%d %H:%M:%S %Z")
    return README.format(version=source.snapshot.service.version, made=made, files=files, taken_out=TAKEN_OUT)


def _json(content: Any) -> str:
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


def _dumped(reports: Iterable[Report]) -> list[dict[str, Any]]:
    return [report.model_dump(mode="json") for report in reports]


def _settings(source: Gathered) -> dict[str, Any]:
    service, live = source.snapshot.service, source.snapshot.of(records.LIVE_SETTINGS)
    settings = live.value.over(service.settings) if live else service.settings
    return {
        "venue": service.venue,
        "from": [{"kind": layer.kind.value, "name": layer.name} for layer in service.layers],
        "tasks_changed": to_builtins(live.value.tasks) if live else {},
        "settings": to_builtins(settings),
    }


def _health(source: Gathered) -> dict[str, Any]:
    """The whole status, but for what has a file of its own."""
    status = status_from(source.snapshot, source.health).model_dump(mode="json")
    return {key: value for key, value in status.items() if key not in ("processes", "selftest")}


def _versions(source: Gathered) -> dict[str, Any]:
    return versions_of(source.snapshot.service.version)


def _checks(source: Gathered) -> dict[str, Any]:
    return checks_from(source.snapshot).model_dump()


def _processes(source: Gathered) -> list[dict[str, Any]]:
    return _dumped(processes_from(source.snapshot))


def _tasks(source: Gathered) -> list[dict[str, Any]]:
    return _dumped(tasks_from(source.snapshot))


def _changes(source: Gathered) -> list[dict[str, Any]]:
    return _dumped(change_from(change) for change in source.changes)


def _selftest(source: Gathered) -> dict[str, Any] | None:
    machine = machine_from(source.snapshot)
    return machine.model_dump() if machine else None


def _timing(source: Gathered) -> dict[str, Any]:
    return timing_from(source.timings, source.snapshot.camera.shutter_delay_ms).model_dump()


def _log(source: Gathered) -> str:
    log = log_from(source.log)
    missing = f"{log.left_out} lines were left out, {log.older} older ones are gone"
    lines = [
        f"{_local(line.at)} {line.level.value:7} {line.process}: {line.text}{_times(line.times)}" for line in log.lines
    ]
    return "\n".join([missing, *lines, ""])


def _local(at: float) -> str:
    return time.strftime("%Y-%m-%d %H:%M:%S", time.localtime(at))


def _times(times: int) -> str:
    return f" ({times} times)" if times > 1 else ""


FILES: tuple[tuple[str, str, Callable[[Gathered], Any]], ...] = (
    ("versions.json", "PSLV, Python, system, libraries, processor", _versions),
    ("settings.json", "the settings in effect, and the files that they come from", _settings),
    ("selftest.json", "how well this machine keeps time, measured at the start; null: not measured", _selftest),
    ("health.json", "whether robots are served and how well; cameras, clients and their lags", _health),
    ("checks.json", "what the checks of light, lines and camera found", _checks),
    ("processes.json", "the processes: state, restarts, last words", _processes),
    ("tasks.json", "the tasks: rate, times and misses over the last seconds", _tasks),
    ("timing.json", f"histograms of the tasks' times and of the lags; {SINCE_START}", _timing),
    ("log.txt", "the newest lines that the processes printed, in this machine's local time", _log),
    ("changes.json", f"the newest {CHANGES} changes made on the page", _changes),
)
"""Name of each file, what it is, and what makes it."""

"""Which sources of images there are to choose from, and whether the service could start with one of them."""

import subprocess
import sys
from http import HTTPStatus
from pathlib import Path

import msgspec

from app.web.problems import RequestRefused
from vision_core.rtdb.infos import ServiceInfo
from vision_core.settings.layers import LayerKind
from vision_core.settings.schema import SYNTHETIC, Settings
from vision_core.startup import PREFLIGHT

KEY = "source.uri"
DEVICES = Path("/dev")
PATIENCE_S = 30.0


def sources_with(*chosen: str) -> list[str]:
    """Sources to choose from: the simulated camera, those that are chosen, and the cameras of this machine."""
    numbers = (path.name.removeprefix("video") for path in DEVICES.glob("video*"))
    devices = [f"camera:{number}" for number in sorted(map(int, filter(str.isdecimal, numbers)))]
    return list(dict.fromkeys([SYNTHETIC, *chosen, *devices]))


def is_chosen_at_start(service: ServiceInfo) -> bool:
    """Does the command line (``--source``) choose the source, whatever the settings say?"""
    options = (layer.table for layer in service.layers if layer.kind is LayerKind.OPTIONS)
    return any("uri" in table.get("source", {}) for table in options)


def check_source(settings: Settings, service: ServiceInfo) -> None:
    """Try whether a start with these settings would find its source, as each start does: a process opens it.

    Raises RequestRefused when it would not, and when the command line chooses the source.
    """
    asked = f"{KEY} = {settings.source.uri}"
    if is_chosen_at_start(service):
        found, accepted = "--source of the command line, which comes first", "a start of the service without --source"
        raise RequestRefused(HTTPStatus.CONFLICT, asked, found=found, accepted=accepted, field=KEY)
    command = [sys.executable, "-m", PREFLIGHT]
    try:
        tried = subprocess.run(
            command, input=msgspec.json.encode(settings), capture_output=True, check=False, timeout=PATIENCE_S
        )
    except subprocess.TimeoutExpired:
        found, accepted = f"no answer within {PATIENCE_S:g} s", "a source that can be opened"
        raise RequestRefused(
            HTTPStatus.UNPROCESSABLE_ENTITY, asked, found=found, accepted=accepted, field=KEY
        ) from None
    if tried.returncode:
        said = tried.stderr.decode(errors="replace").strip().rpartition("\n")[2]
        what, _, rest = said.partition("; found: ")
        found, _, accepted = rest.partition("; accepted: ")
        raise RequestRefused(
            HTTPStatus.UNPROCESSABLE_ENTITY,
            asked,
            found=f"{what}: {found}" if found else what or "no message",
            accepted=accepted or "a source that can be opened",
            field=KEY,
        )

"""What earlier sessions of the page left: where it is kept, and the layers of settings with it."""

import hashlib
import os
import re
import time
from collections.abc import Callable, Sequence
from contextlib import closing
from pathlib import Path

from app.web.configuration.overlay import overlay_from
from app.web.storage.document import Document
from vision_core.errors import ServiceError, SettingsError
from vision_core.native.kernel_folder import data_folder
from vision_core.settings.layers import Layer
from vision_core.venues.loader import settings_from_layers, with_overlay

MEMORY = Path("/dev/shm")  # noqa: S108 (a folder of our own in it, which nobody else can read)
PROBE = ".writable"


def scope_of(venue: str | None, config: Path | None) -> str:
    """Name for a venue and a further file; changes that were made for one are not applied to another."""
    names = [_named(name) for name in (venue, str(config) if config else None) if name]
    return "-".join(names) or "default"


def database_folder(chosen: Path | None) -> tuple[Path, str]:
    """The folder of the databases, and a line for the log when it is not the one that was wanted.

    chosen: by --database. Raises ServiceError when it cannot be written; without it the data folder is taken, or a
    folder in memory where that cannot be written.
    """
    if chosen is not None:
        if error := _unwritable(chosen):
            raise ServiceError(f"--database {chosen}", found=error, accepted="a folder that can be written")
        return chosen, ""
    folder = data_folder()
    error = _unwritable(folder)
    if not error:
        return folder, ""
    instead = MEMORY / f"pslv-{os.geteuid()}" / "state"
    if _unwritable(instead):
        raise ServiceError(f"data folder {folder}", found=error, accepted="PSLV_DATA_DIR or --database names another")
    return instead, f"{folder}: {error}: what is changed on the page is kept in {instead}, until this machine restarts"


def with_kept_changes(path: Path, layers: Sequence[Layer], log: Callable[[str], None]) -> list[Layer]:
    """Layers with what was changed on the page before; without it when it does not fit to the files any more.

    path: of the document. log: takes lines that say what is wrong. Raises ServiceError when the document cannot be
    opened, and SettingsError when the files alone cannot be used.
    """
    base = settings_from_layers(with_overlay(layers, {}))
    with closing(Document(path)) as document:
        if document.notice:
            log(document.notice)
        overlay = overlay_from(document.entries(), base, time.time())
    try:
        changed = with_overlay(layers, overlay)
        settings_from_layers(changed)
    except SettingsError as error:
        log(f"what was changed on the page is left out: {error}")
        return with_overlay(layers, {})
    if overlay:
        log(f"{len(overlay)} settings were changed on the page: {', '.join(sorted(overlay))}"[:400])
    return changed


def _named(name: str) -> str:
    """A short name: of a shipped file its own, of another file with a few letters that stand for its folder."""
    if not name.endswith(".toml"):
        return name
    path = Path(name).absolute()
    stem = re.sub(r"[^A-Za-z0-9_-]+", "-", path.stem)[:40]
    return f"{stem}-{hashlib.sha256(str(path.parent).encode()).hexdigest()[:6]}"


def _unwritable(folder: Path) -> str:
    """Why nothing can be written into a folder; empty when it can."""
    try:
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        probe = folder / f"{PROBE}-{os.getpid()}"
        probe.write_bytes(b"0" * 4096)
        probe.unlink()
    except OSError as error:
        return error.strerror or str(error)
    return ""

"""From what the command line says to the settings with which a service is started."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from app.launch.kept_changes import database_folder, scope_of, with_kept_changes
from vision_core.settings.layers import Layer
from vision_core.settings.schema import Settings
from vision_core.tasks.table import check_table
from vision_core.venues.loader import layers_of, place_of, settings_from_layers


@dataclass(frozen=True, slots=True)
class StartOptions:
    """What the command line or the environment says. A restart reads the same files again."""

    venue: str | None = None
    config: str | None = None
    """Path of a further file of settings."""
    database: str | None = None
    """Folder of what is changed on the page."""
    options: Mapping[str, str | int | None] = field(default_factory=dict)
    """Values by dotted keys of the settings; None: not given."""


@dataclass(frozen=True, slots=True)
class Prepared:
    """What a service is to be started with."""

    settings: Settings
    layers: Sequence[Layer]
    """Where the settings come from."""
    document: Path
    """The file of what is changed on the page."""
    scope: str
    """Which venue and further file the settings are of, for names of files."""


def prepare(start: StartOptions, log: Callable[[str], None]) -> Prepared:
    """Read the files and what was changed on the page, and check all of it. Raises SettingsError and ServiceError.

    log: takes lines for a person.
    """
    folder, notice = database_folder(Path(start.database) if start.database else None)
    if notice:
        log(notice)
    config = Path(start.config) if start.config else None
    scope = scope_of(start.venue, config)
    document = folder / f"venue-{scope}.db"
    layers = with_kept_changes(document, layers_of(start.venue, config, start.options), log)
    settings = settings_from_layers(layers)
    check_table(settings, lambda key: place_of(key, layers))
    return Prepared(settings, layers, document, scope)

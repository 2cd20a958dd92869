"""The shipped field presets, and the names of what is shipped."""

from functools import cache

import msgspec

from vision_core.errors import SettingsError
from vision_core.settings.schema import FieldSettings
from vision_core.venues.loader import config_folder, find_file, read_layer


def shipped(kind: str) -> list[str]:
    """Names of the files of config/<kind>."""
    return sorted(path.stem for path in (config_folder() / kind).glob("*.toml"))


@cache
def shipped_fields() -> dict[str, FieldSettings]:
    """The presets of config/fields by their names."""
    return {name: field_of(name) for name in shipped("fields")}


def field_of(preset: str) -> FieldSettings:
    """The measures of a field preset. Raises SettingsError."""
    layer = read_layer(find_file("fields", preset))
    try:
        return msgspec.convert(layer.table.get("field"), FieldSettings)
    except msgspec.ValidationError as error:
        raise SettingsError(f"field {preset}", found=str(error), accepted="the table [field]") from None

"""What is odd about settings that are accepted: the warnings of ``pslv config validate``."""

from collections.abc import Callable, Iterator

from vision_core.color.lookup_table import compile_color_table
from vision_core.color.palette_warnings import palette_warnings
from vision_core.models.camera_setup import CameraSetup
from vision_core.objects.robots.pattern_warnings import pattern_warnings
from vision_core.patterns.match_rules import match_warnings
from vision_core.settings.schema import Settings
from vision_core.venues.orientation import orientation_warnings


def venue_warnings(settings: Settings, place_of: Callable[[str], str]) -> Iterator[str]:
    """One sentence each. The service works all the same, but probably not as is wanted.

    place_of: names the file and line that set a key. Raises SettingsError for a pattern that cannot be read.
    """
    yield from match_warnings(settings, place_of)
    setup, table = CameraSetup.from_settings(settings), compile_color_table(settings.colors)
    for violation in (
        *orientation_warnings(settings, setup),
        *palette_warnings(settings.colors, table),
        *pattern_warnings(settings, setup.model, table),
    ):
        yield f"{place_of(violation.key)}: {violation.key}: {violation.found}; accepted: {violation.accepted}"

"""Are the painted lines those of another field than the venue's? Slow, and never on the hot path."""

from vision_core.errors import SettingsError
from vision_core.geometry import Bytes
from vision_core.models.camera import CameraModel
from vision_core.regions.lines import line_check
from vision_core.settings.schema import FieldSettings
from vision_core.types.reasons import Reason
from vision_core.types.regions import LineCheck
from vision_core.venues.presets import shipped_fields

MIN_OWN = 0.8
"""Where such a share of the own lines is seen, no other field is tried."""
MIN_LINES, MIN_FOUND, MAX_OUTSIDE = 6, 0.75, 0.4
"""Another field fits when so many of its lines are seen, and such a share of them; most of them lie in the picture."""
MIN_GAIN = 4
"""It explains so many lines more than the own one."""


def other_field_reason(pixels: Bytes, field: FieldSettings, camera: CameraModel) -> Reason | None:
    """That the lines are where another preset has them, seen by the same camera; None where they are not."""
    own = _checked(pixels, field, camera)
    if own is not None and own.known and own.found >= MIN_OWN * own.known:
        return None
    seen = own.found if own else 0
    best, name = None, ""
    for preset, other in shipped_fields().items():
        check = _checked(pixels, other, camera) if other.name != field.name else None
        if check is None or check.found < max(MIN_LINES, seen + MIN_GAIN, MIN_FOUND * check.known):
            continue
        if check.outside <= MAX_OUTSIDE and (best is None or check.found > best.found):
            best, name = check, preset
    if best is None:
        return None
    found = f"{seen} of {own.known}" if own and own.known else "none"
    text = (
        f"the field is another one: {best.found} of {best.known} painted lines are where field_preset = {name!r} has "
        f"them, {found} where field {field.name!r} has them"
    )
    return Reason(text, f"Set field_preset = {name!r}, with the same camera.", is_calibration=True)


def _checked(pixels: Bytes, field: FieldSettings, camera: CameraModel) -> LineCheck | None:
    """The check of a field's lines; None where the camera makes them wider than the picture."""
    try:
        return line_check(pixels, field, camera)
    except SettingsError:
        return None

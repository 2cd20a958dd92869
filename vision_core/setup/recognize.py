"""Which field preset is the field in the pictures? Each is searched in them without a click."""

from collections.abc import Sequence

from vision_core.calibration.result import Progress
from vision_core.calibration.solve import calibrate
from vision_core.geometry import Bytes
from vision_core.settings.schema import FieldSettings
from vision_core.setup.camera import trial_of
from vision_core.setup.findings import FieldTrial, painted_share

MAX_SEARCHED = 4
"""More pictures make the search slow and no surer."""


def recognize_field(
    pictures: Sequence[Bytes],
    presets: dict[str, FieldSettings],
    *,
    marker_height_m: float,
    height_m: float | None,
    progress: Progress,
) -> tuple[FieldTrial, ...]:
    """Every preset's trial, the best first: accepted ones, then by the share of their lines that is seen.

    pictures: shape (height, width, 3) each, of one size; height_m: of the camera, by tape measure. Lines do not tell
    how large a field is, so of presets of the same proportions the order says nothing. Raises what progress raises.
    """
    trials = []
    for number, (name, field) in enumerate(presets.items()):
        progress(f"trying {name}", number / len(presets))
        if field.line_width_m <= 0.0:
            continue
        seen = pictures[:MAX_SEARCHED]
        found = calibrate(seen, field, None, height_m=height_m, marker_height_m=marker_height_m, advises=False)
        trials.append(FieldTrial(name, trial_of(found, field, pictures[0], len(seen)), painted_share(found.lines)))
    progress("done", 1.0)
    return tuple(sorted(trials, key=lambda one: (one.camera.camera is None, -one.painted)))

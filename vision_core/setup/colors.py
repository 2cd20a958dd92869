"""Colors of a new venue: measured in its pictures, and what the classes make of every pixel."""

from collections.abc import Sequence

import numpy as np

from vision_core.calibration.result import Progress
from vision_core.clock import Instant
from vision_core.color.explain import in_words
from vision_core.color.light import Lighting
from vision_core.color.lookup_table import compile_color_table
from vision_core.color.samples import hex_from_bgr
from vision_core.errors import SettingsError
from vision_core.evaluation.overlay import draw_classes
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import encode_png
from vision_core.palette.find import find_colors
from vision_core.setup.choices import needed_colors
from vision_core.setup.draft import NOTHING, Draft
from vision_core.setup.findings import ClassMap, ColorTrial, PaintSeen, Sampled
from vision_core.setup.venue_file import settings_of


def sample_at(draft: Draft, pixels: Bytes, place_px: tuple[int, int], radius_px: int) -> Sampled:
    """Median color of the square round a pixel. pixels: shape (height, width, 3), of the draft's size.

    Raises SettingsError for a place outside of the picture.
    """
    x, y = place_px
    height, width, _ = pixels.shape
    if not (0 <= x < width and 0 <= y < height):
        accepted = f"0..{width - 1}, 0..{height - 1}: the picture has {width}x{height} px"
        raise SettingsError(f"a sample at {x}, {y}", found="a place outside of the picture", accepted=accepted)
    lit = lit_picture(draft, pixels)
    square = lit[max(y - radius_px, 0) : y + radius_px + 1, max(x - radius_px, 0) : x + radius_px + 1]
    median = np.median(square.reshape(-1, 3), axis=0)
    return Sampled(hex_from_bgr(median.tolist()), in_words(median))


def find_all_colors(draft: Draft, pictures: Sequence[Bytes], progress: Progress) -> ColorTrial:
    """Every color of markers and ball, from pictures that show robots in about the same light.

    pictures: shape (height, width, 3) each, of the draft's size. Raises SettingsError, and what progress raises.
    """
    found = find_colors(pictures, settings_of(draft), lambda share, what: progress(what, share))
    needed = {*needed_colors(draft), NOTHING}
    return ColorTrial(
        samples={name: tuple(dict.fromkeys(c)) for name, c in found.colors.samples.items() if name in needed and c},
        sampling=found.colors.sampling,
        light=found.colors.light,
        paints=tuple(PaintSeen(paint.name, paint.color, paint.patches) for paint in found.paints),
        robots=sum(picture.robots for picture in found.pictures),
        with_id=sum(picture.with_id for picture in found.pictures),
        balls=sum(picture.balls for picture in found.pictures),
        reasons=found.reasons,
        is_accepted=found.accepted,
    )


def class_map(draft: Draft, pixels: Bytes) -> ClassMap:
    """The class of every pixel. pixels: shape (height, width, 3), of the draft's size. Raises SettingsError."""
    table = compile_color_table(settings_of(draft).colors)
    lit = lit_picture(draft, pixels)
    counts = np.bincount(table.classes_of(lit).ravel(), minlength=len(table.names))
    named = {name: number for number, name in enumerate(table.names) if number}
    shares = {name: float(counts[number] / counts.sum()) for name, number in named.items()}
    colors = {name: hex_from_bgr(table.mean_bgr[number].tolist()) for name, number in named.items()}
    return ClassMap(encode_png(draw_classes(lit, table)), shares, colors)


def lit_picture(draft: Draft, pixels: Bytes) -> Bytes:
    """A picture in the light of the draft's first one, as perception sees it. Raises SettingsError."""
    settings = settings_of(draft)
    lit: Bytes = Lighting(settings, CameraSetup.from_settings(settings)).lit(pixels, Instant(0)).copy()
    return lit

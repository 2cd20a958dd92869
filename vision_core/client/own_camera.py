"""``--camera``: pictures of the robot's own camera beside PSLV's views of the same instants."""

import argparse
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TypeAlias

from vision_core.client.comparison import Comparison, compare, draw_comparison
from vision_core.client.recognition import Palette, PictureGeometry, Placement, load_palette, recognize
from vision_core.client.view import View
from vision_core.errors import SettingsError
from vision_core.geometry import Bytes
from vision_core.models.mirror import Mirror
from vision_core.protocol.options import Options

OpenPictures: TypeAlias = Callable[[Path], Iterator[Bytes]]


class OwnCamera:
    """The pictures of a robot's own camera, one for each view, in their order."""

    def __init__(self, pictures: Iterator[Bytes], placement: Placement, palette: Palette) -> None:
        self._pictures = pictures
        self._placement = placement
        self._palette = palette
        self._geometry: PictureGeometry | None = None
        self._seen: View | None = None
        self._comparison: Comparison | None = None

    def look(self, pslv: View, mirror: Mirror) -> bool:
        """Compare the next picture with PSLV's view; False when there are no more pictures.

        The mirror is looked for in the first picture. Raises SourceError for a picture that shows nothing, or when the
        first one shows no mirror.
        """
        picture = next(self._pictures, None)
        if picture is None:
            return False
        if self._geometry is None or self._geometry.mirror != mirror:
            self._geometry = self._placement.geometry(picture, mirror, self._palette)
        recognized = recognize(picture, self._geometry, self._palette, directions=len(pslv.px))
        self._seen = recognized.view(mirror, pslv.time_s)
        self._comparison = compare(self._seen, pslv)
        return True

    @property
    def sentence(self) -> str:
        """The last comparison in one line."""
        return "" if self._comparison is None else self._comparison.sentence

    @property
    def plain(self) -> dict[str, object]:
        """The last comparison as JSON types; None for what is not known."""
        if self._seen is None or self._comparison is None:
            return {}
        counted = self._comparison
        return {
            "same_type": counted.share,
            "median_px": _known(counted.median_px),
            "p95_px": _known(counted.p95_px),
            "ball_px": _known(counted.ball_px),
            "edges": [list(edge) for edge in zip(self._seen.letters.tolist(), self._seen.px.tolist(), strict=True)],
        }

    def draw(self, pslv: View, mirror: Mirror, options: Options) -> Bytes:
        """The last comparison: red green blue. pslv: the view that was compared."""
        assert self._seen is not None
        return draw_comparison(self._seen, pslv, mirror, options)


def own_camera(asked: argparse.Namespace, open_pictures: OpenPictures | None) -> OwnCamera:
    """The camera that the options name. Raises SettingsError and SourceError."""
    if open_pictures is None:
        found = "python -m vision_core.client, which has no OpenCV to read pictures"
        raise SettingsError("--camera", found=found, accepted="the command pslv client")
    placement = Placement(
        center_px=tuple(asked.center) if asked.center else None,
        rim_px=asked.rim,
        scale=asked.scale,
        nearest_mm=asked.nearest,
        ball_radius_mm=asked.ball_radius,
        turn_deg=asked.turn,
        mirrored=asked.mirrored,
    )
    pictures = open_pictures(asked.camera)
    return OwnCamera(pictures, placement, load_palette(asked.palette))


def add_camera_options(parser: argparse.ArgumentParser) -> None:
    """The options of the robot's own camera."""
    default = Placement()
    group = parser.add_argument_group("the robot's own camera", "Its pictures beside PSLV's views, compared.")
    add = group.add_argument
    camera_help = "a picture, a folder of pictures or a video: each picture beside one view; --draw draws both"
    add("--camera", type=Path, metavar="FILE", help=camera_help)
    add("--palette", default="rendered", help="rendered, drawn, or a file: see docs/onboard.md [%(default)s]")
    add("--center", type=float, nargs=2, metavar=("X", "Y"), help="of the mirror in the picture [found]")
    add("--rim", type=float, metavar="PX", help="radius of the mirror's rim in the picture [found]")
    scale_help = "pixels of the picture per pixel of equation 1 [that of PSLV's pictures of this size]"
    add("--scale", type=float, help=scale_help)
    add("--nearest", type=float, metavar="MM", default=default.nearest_mm, help="nearest floor it sees [%(default)g]")
    ball_help = "radius of the ball, whose center is seen farther out than it stands [%(default)g]"
    add("--ball-radius", type=float, metavar="MM", default=default.ball_radius_mm, help=ball_help)
    turn_help = "where the heading is in the picture, anticlockwise from its upper edge [%(default)g]"
    add("--turn", type=float, metavar="DEG", default=0.0, help=turn_help)
    add("--mirrored", action="store_true", help="left and right are exchanged, as the camera under a mirror has them")


def _known(value: float) -> float | None:
    return None if math.isnan(value) else value

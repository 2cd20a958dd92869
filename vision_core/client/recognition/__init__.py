"""The on-board image processing that PSLV replaces (paper, section 3.4), with NumPy alone.

Theory of operation. A picture through an omnidirectional mirror is resampled along evenly spaced rays from the
mirror's center (``polar``). Every sample gets a label by the nearest reference color (``palette``). Outward along each
ray, floor, ball and lines are passed; a line is white and narrow, with floor behind it. The first longer run of
anything else is the nearest edge (``edges``): its beginning is placed between samples, its colors tell the type. An
on-board camera sees a robot's team, not its number. The ball is the largest region of its color in front of the edges
(``ball``); a smaller one is found by its share of the light of pixels (``small_ball``).

Radii are those of equation 1, and the result has the form of a ``see``: the same program can use either eye.

    from vision_core.client.recognition import DRAWN, paper_geometry, recognize

    recognized = recognize(picture, paper_geometry(mirror), DRAWN)

Where the mirror is in other pictures: ``Placement``, which finds it by its ``rim``.

Files, outside in: ``recognize``, ``edges``, ``ball``, ``small_ball``, ``placement``, ``rim``, ``polar``, ``geometry``,
``palette``, ``palette_file``, ``runs``.
"""

from vision_core.client.recognition.geometry import PictureGeometry, paper_geometry
from vision_core.client.recognition.palette import DRAWN, RENDERED, Palette, Surface
from vision_core.client.recognition.palette_file import load_palette
from vision_core.client.recognition.placement import Placement
from vision_core.client.recognition.recognize import Recognized, recognize
from vision_core.client.recognition.rim import Rim, find_rim

__all__ = [
    "DRAWN",
    "RENDERED",
    "Palette",
    "PictureGeometry",
    "Placement",
    "Recognized",
    "Rim",
    "Surface",
    "find_rim",
    "load_palette",
    "paper_geometry",
    "recognize",
]

"""Classes by samples: a color has the class of the nearest measured color, unless all of them are too far away.

Samples of what is *not* searched (carpet, lines, robots' bodies) are listed under ``none``: colors nearest to them have
no class. So the border between two samples lies halfway, and a class grows only where nothing else was measured.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from vision_core.color.spaces import ycc_from_bgr
from vision_core.geometry import Floats, Mask
from vision_core.settings.schema import SamplingSettings

NONE = "none"
"""Name of the list of samples that have no class."""


def hex_from_bgr(bgr: Sequence[float]) -> str:
    """A color as "#rrggbb"."""
    blue, green, red = (min(max(round(level), 0), 255) for level in bgr)
    return f"#{red:02x}{green:02x}{blue:02x}"


def bgr_from_hex(text: str) -> tuple[int, int, int]:
    """Blue green red of "#rrggbb"."""
    return int(text[5:7], 16), int(text[3:5], 16), int(text[1:3], 16)


def sampled_names(samples: Mapping[str, Sequence[str]]) -> tuple[str, ...]:
    """The classes that have samples, in their order."""
    return tuple(name for name in samples if name != NONE)


def nearest_samples(
    bgr: Floats, samples: Mapping[str, Sequence[str]], settings: SamplingSettings
) -> tuple[NDArray[np.intp], Floats]:
    """For each color the number of its nearest sample, counted over all classes, and its distance.

    bgr: shape (n, 3); returns shapes (n,), (n,). The distance is Euclidean in luma, Cb, Cr with the luma weighted less:
    over a field light varies more than color does [grey levels]. Without samples all distances are infinite.
    """
    colors = [bgr_from_hex(text) for texts in samples.values() for text in texts]
    nearest, least = np.zeros(len(bgr), dtype=np.intp), np.full(len(bgr), np.inf)
    if not colors:
        return nearest, least
    scale = np.array([settings.luma_weight, 1.0, 1.0])
    places, measured = ycc_from_bgr(bgr) * scale, ycc_from_bgr(colors) * scale
    for number, place in enumerate(measured):
        distance = np.sqrt(((places - place) ** 2).sum(axis=1))
        closer = distance < least
        nearest[closer], least[closer] = number, distance[closer]
    return nearest, least


def claims_by_samples(bgr: Floats, samples: Mapping[str, Sequence[str]], settings: SamplingSettings) -> dict[str, Mask]:
    """Which colors each class claims: shape (n, 3) -> per class shape (n,)."""
    nearest, distance = nearest_samples(bgr, samples, settings)
    class_of_sample = np.array([name for name, texts in samples.items() for _ in texts] or [NONE])
    owners = class_of_sample[nearest]
    near = distance <= settings.tolerance
    return {name: near & (owners == name) for name in sampled_names(samples)}

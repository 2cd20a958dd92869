"""How like what is looked for a thing is, by its area."""

import numpy as np

from vision_core.geometry import Floats


def likeness(share: Floats) -> Floats:
    """How near measured areas are to the predicted ones, 0..1: the root of the smaller over the larger."""
    with np.errstate(divide="ignore"):
        alike: Floats = np.sqrt(np.minimum(share, 1.0 / share))
    return alike

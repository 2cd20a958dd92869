"""Sizes of blobs in words, for verdicts on robots and ball."""

import math


def size_words(area_px: float, expected_px: float, shares: tuple[float, float], *, is_disc: bool) -> tuple[str, str]:
    """How large a blob is, and how large it may be: diameters of a disc, areas of other shapes.

    area_px: of the blob; expected_px: of the object at its place; shares: least and greatest accepted share of it.
    """
    sizes = [area_px, *(share * expected_px for share in shares)]
    if is_disc:
        size, low, high = (2.0 * math.sqrt(area / math.pi) for area in sizes)
        return f"circle {size:.3g} px across", f"{low:.3g} to {high:.3g} px"
    size, low, high = sizes
    return f"area {size:.3g} px", f"{low:.3g} to {high:.3g} px"

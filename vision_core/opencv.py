"""The one door to OpenCV, typed. Its own return types fail mypy strict, and its pools would inherit
real-time priority, so they are switched off here, once."""

from pathlib import Path
from typing import cast

import cv2
import numpy as np

from vision_core.errors import SourceError
from vision_core.geometry import Bytes

cv2.setNumThreads(1)


def read_picture(path: Path) -> Bytes:
    """A picture file as blue green red, shape (height, width, 3). Raises SourceError."""
    try:
        data = np.fromfile(path, dtype=np.uint8)
    except OSError as error:
        raise SourceError(f"picture {path}", found=error.strerror or str(error)) from None
    image = cv2.imdecode(data, cv2.IMREAD_COLOR) if data.size else None
    if image is None:
        found = "an empty file" if not data.size else "a file that is no picture, or a damaged one"
        raise SourceError(f"picture {path}", found=found, accepted="JPEG, PNG, BMP, TIFF or WebP")
    return cast("Bytes", image)


def write_picture(path: Path, image: Bytes) -> None:
    """Save a picture in the format that the file's ending names. Raises SourceError."""
    try:
        fine = cv2.imwrite(str(path), image)
    except cv2.error as error:
        raise SourceError(f"picture {path}", found=str(error), accepted="a name that ends with .png or .jpg") from None
    if not fine:
        raise SourceError(f"picture {path}", found="it cannot be written", accepted="a folder that may be written")


def encode_jpeg(image: Bytes, quality: int = 80) -> bytes:
    """A picture as the bytes of a JPEG file."""
    fine, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])
    assert fine
    return cast("bytes", data.tobytes())

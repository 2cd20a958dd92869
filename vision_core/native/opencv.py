"""The one door to OpenCV, with types that mypy accepts.

OpenCV's threads are switched off: they would inherit the real-time priority of the process that uses them.
"""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias, cast

CAMERA_PATIENCE_S = 2
"""A camera that delivers no image for this long counts as disconnected [s]. OpenCV reads the variable when it is
loaded; its default of 10 s is longer than a process may be silent before the supervisor ends it."""
os.environ.setdefault("OPENCV_VIDEOIO_V4L_SELECT_TIMEOUT", str(CAMERA_PATIENCE_S))

import cv2  # noqa: E402
import numpy as np  # noqa: E402
from numpy.typing import NDArray  # noqa: E402

from vision_core.errors import SourceError  # noqa: E402
from vision_core.geometry import Bytes  # noqa: E402
from vision_core.native.picture_size import picture_size  # noqa: E402
from vision_core.user_files import check_regular, read_bytes  # noqa: E402

cv2.setNumThreads(1)

Point: TypeAlias = tuple[float, float]
Color: TypeAlias = tuple[int, int, int]
"""Blue, green, red."""

FIXED_BITS = 4
FIXED = 1 << FIXED_BITS

MAX_SIDE_PX = 8192
"""Largest width and height of a picture: those of the settings' camera."""
MAX_PICTURE_BYTES = 300_000_000
"""Largest file of a picture: MAX_SIDE_PX squared, three bytes a pixel and no compression, is a third less."""
HEADER_BYTES = 1 << 20
"""A picture's size stands within so many bytes; Exif data and color profiles may come before it."""
PICTURE_FORMATS = "JPEG, PNG, BMP, TIFF or WebP"
FILLED_BITS = (10, 12)
"""Bits of a pixel that cameras deliver in 16."""
MIN_FILLED = 512
"""A picture without a brighter pixel, of 65535, is black however many bits were filled."""
MAX_HZ = 1000.0
VIDEOS = "a video that FFmpeg can decode: MP4, AVI, MKV, ..."
YUYV = cv2.VideoWriter.fourcc(*"YUYV")
CAMERA_BUFFERS = 2
"""Images that the driver buffers: one is filled while the other is read. More of them add delay and nothing else."""


def read_picture(path: Path, size_px: tuple[int, int] | None = None) -> Bytes:
    """A picture file as blue green red, shape (height, width, 3).

    Of 16 bits per channel the upper 8 that the camera filled are kept: many deliver 10 or 12 bits in 16.
    size_px: width and height that it must have; a picture of another size is refused before it is decoded.
    Raises SourceError when it cannot be read, is no picture, or has another size or more than MAX_SIDE_PX a side.
    """
    asked = f"picture {path}"
    data = read_bytes(path, asked, SourceError, max_bytes=MAX_PICTURE_BYTES)
    check_picture_size(asked, data, size_px)
    try:
        image = cv2.imdecode(np.frombuffer(data, dtype=np.uint8), cv2.IMREAD_COLOR | cv2.IMREAD_ANYDEPTH)
    except cv2.error:  # a header that OpenCV refuses
        image = None
    if image is None:
        raise SourceError(asked, found="a damaged picture", accepted=PICTURE_FORMATS)
    if image.dtype == np.uint16:
        image = _eight_bits(cast("NDArray[np.uint16]", image))
    elif image.dtype != np.uint8:
        raise SourceError(asked, found=f"{image.dtype} in each channel", accepted="8 or 16 bits")
    height, width, _ = image.shape
    if size_px is not None and (width, height) != size_px:  # a picture that its Exif data turn by a right angle
        raise _wrong_size(asked, (width, height), size_px)
    return cast("Bytes", image)


def _eight_bits(image: NDArray[np.uint16]) -> Bytes:
    """The upper 8 of the bits that a camera filled: all 16, or the lower 12 or 10 where no pixel has more.

    A picture that is black even as one of 10 bits was taken with the lens cap on.
    """
    brightest = int(image.max())
    filled = [bits for bits in FILLED_BITS if MIN_FILLED <= brightest < 2**bits]
    bits = min(filled, default=16)
    eight: Bytes = (image >> (bits - 8)).astype(np.uint8)
    return eight


def check_picture_size(asked: str, data: bytes, size_px: tuple[int, int] | None) -> None:
    """Raise SourceError unless the header of a picture says a size that can be decoded, and the one that is wanted.

    data: the file, or at least its first HEADER_BYTES; size_px: width and height, either way round as Exif data may
    turn the picture; None: any.
    """
    found = picture_size(data)
    if found is None:
        what = "a file that is no picture, or a damaged one" if data else "an empty file"
        raise SourceError(asked, found=what, accepted=PICTURE_FORMATS)
    if size_px is not None and found not in (size_px, size_px[::-1]):
        raise _wrong_size(asked, found, size_px)
    if not 0 < min(found) <= max(found) <= MAX_SIDE_PX:
        raise SourceError(asked, found=f"{found[0]}x{found[1]} px", accepted=f"sides of 1 to {MAX_SIDE_PX} px")


def _wrong_size(asked: str, found_px: tuple[int, int], wanted_px: tuple[int, int]) -> SourceError:
    accepted = f"{wanted_px[0]}x{wanted_px[1]} (camera.width_px, camera.height_px of the venue)"
    return SourceError(asked, found=f"{found_px[0]}x{found_px[1]} px", accepted=accepted)


def ycc_picture(image: Bytes) -> Bytes:
    """Luma, Cb, Cr (ITU-R BT.601, full range, 128 for no chroma) of a picture: same shape."""
    return cast("Bytes", cv2.cvtColor(image, cv2.COLOR_BGR2YCrCb)[..., (0, 2, 1)])


def luma_picture(image: Bytes) -> Bytes:
    """Luma of a picture: shape (height, width, 3) -> (height, width)."""
    return cast("Bytes", cv2.cvtColor(image, cv2.COLOR_BGR2GRAY))


def write_yuyv(image: Bytes, pixels: Bytes) -> None:
    """Write a camera's YUYV 4:2:2 buffer as blue green red, in one pass: shapes (height, width, 2), (height, width, 3).

    ITU-R BT.601 with luma 16..235, as V4L2 has it by default.
    """
    cv2.cvtColor(image, cv2.COLOR_YUV2BGR_YUYV, dst=pixels)


def write_picture(path: Path, image: Bytes) -> None:
    """Save a picture in the format that the file's ending names. Raises SourceError."""
    try:
        is_written = cv2.imwrite(str(path), image)
    except cv2.error as error:
        raise SourceError(f"picture {path}", found=str(error), accepted="a name that ends with .png or .jpg") from None
    if not is_written:
        raise SourceError(f"picture {path}", found="it cannot be written", accepted="a folder that may be written")


def encode_jpeg(image: Bytes, quality: int = 80) -> bytes:
    """A picture as the bytes of a JPEG file."""
    is_encoded, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])
    assert is_encoded
    return data.tobytes()


def decode_jpeg(data: bytes) -> Bytes:
    """The picture that ``encode_jpeg`` encoded, blue green red, shape (height, width, 3)."""
    return cast("Bytes", cv2.imdecode(np.frombuffer(data, dtype=np.uint8), cv2.IMREAD_COLOR))


def encode_png(image: Bytes) -> bytes:
    """A picture, grey or blue green red, as the bytes of a PNG file."""
    is_encoded, data = cv2.imencode(".png", image)
    assert is_encoded
    return data.tobytes()


def draw_circle(image: Bytes, center_px: Point, radius_px: float, bgr: Color, thickness_px: int = 1) -> None:
    """Draw a circle into a picture, to a 16th of a pixel; nothing where it lies outside."""
    cv2.circle(image, _fixed(center_px), round(radius_px * FIXED), bgr, thickness_px, cv2.LINE_AA, FIXED_BITS)


def draw_line(image: Bytes, start_px: Point, end_px: Point, bgr: Color, thickness_px: int = 1) -> None:
    """Draw a line into a picture, to a 16th of a pixel."""
    cv2.line(image, _fixed(start_px), _fixed(end_px), bgr, thickness_px, cv2.LINE_AA, FIXED_BITS)


def draw_text(image: Bytes, text: str, left_bottom_px: Point, bgr: Color, scale: float = 0.5) -> None:
    """Write one line of ASCII into a picture, white or colored with a dark outline, readable on any background."""
    x, y = round(left_bottom_px[0]), round(left_bottom_px[1])
    rim = [(x + right, y + down, (0, 0, 0)) for right in (-1, 0, 1) for down in (-1, 0, 1)]
    for left, bottom, color in (*rim, (x, y, bgr)):  # a thicker stroke would widen the letters
        cv2.putText(image, text, (left, bottom), cv2.FONT_HERSHEY_SIMPLEX, scale, color, 1, cv2.LINE_AA)


def text_size(text: str, scale: float) -> tuple[int, int]:
    """Width and height of a line of text as ``draw_text`` writes it [px]."""
    (width, height), _ = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, scale, 1)
    return int(width), int(height)


def _fixed(point_px: Point) -> tuple[int, int]:
    return round(point_px[0] * FIXED), round(point_px[1] * FIXED)


def shrink(image: Bytes, width_px: int) -> Bytes:
    """A picture scaled down to a width, its height in proportion; a narrower one as it is."""
    height, width = image.shape[:2]
    if width <= width_px:
        return image
    size = (width_px, round(height * width_px / width))
    return cast("Bytes", cv2.resize(image, size, interpolation=cv2.INTER_AREA))


@dataclass(frozen=True, slots=True)
class Region:
    """A connected region of a mask."""

    area_px: int
    width_px: int
    height_px: int
    center_px: Point


def connected_regions(mask: NDArray[np.bool_]) -> list[Region]:
    """The regions of true pixels, touching ones (diagonally counts) together."""
    _, _, boxes, centers = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    return [
        Region(int(area), int(width), int(height), (float(x), float(y)))
        for (_, _, width, height, area), (x, y) in zip(boxes[1:], centers[1:], strict=True)
    ]


def median_filtered(image: Bytes, side_px: int) -> Bytes:
    """Every pixel the median of the square round it, per channel; side_px: odd."""
    return cast("Bytes", cv2.medianBlur(image, side_px))


class Video:
    """A video file or a camera that is open."""

    def __init__(self, capture: cv2.VideoCapture) -> None:
        self._capture = capture
        self.width_px = round(capture.get(cv2.CAP_PROP_FRAME_WIDTH))
        self.height_px = round(capture.get(cv2.CAP_PROP_FRAME_HEIGHT))
        rate_hz = capture.get(cv2.CAP_PROP_FPS)
        self.rate_hz = rate_hz if 0.0 < rate_hz <= MAX_HZ else 0.0
        """Frames per second according to the file or driver; 0: unknown."""

    def read(self, pixels: Bytes) -> bool:
        """Wait for the next frame and write it into pixels, shape (height, width, 3); False: none, or another size."""
        is_read, image = self._capture.read()
        if not is_read or image.shape[:2] != pixels.shape[:2]:
            return False
        if image.shape[2:] == (2,):
            write_yuyv(cast("Bytes", image), pixels)
            return True
        if image.shape != pixels.shape:
            return False
        np.copyto(pixels, image)
        return True

    def skip(self) -> bool:
        """Leave out the next frame; False when there is none."""
        return bool(self._capture.grab())

    def position_ms(self) -> float:
        """Position of the last frame in a video, or the driver's timestamp of a V4L2 camera's buffer [ms]."""
        return float(self._capture.get(cv2.CAP_PROP_POS_MSEC))

    def close(self) -> None:
        """Close the file or device."""
        self._capture.release()


def open_video(path: Path) -> Video:
    """A video file. Raises SourceError."""
    check_regular(path, f"video {path}", SourceError)
    capture = cv2.VideoCapture(str(path), cv2.CAP_FFMPEG)
    if not capture.isOpened():
        raise SourceError(f"video {path}", found="a file that is no video, or a damaged one", accepted=VIDEOS)
    return Video(capture)


def open_camera(device: str, width_px: int, height_px: int, rate_hz: float) -> Video:
    """Open a V4L2 camera by its device file and ask for a size and rate; it may deliver others. Raises SourceError."""
    capture = cv2.VideoCapture(device, cv2.CAP_V4L2)
    if not capture.isOpened():
        present = ", ".join(sorted(str(path) for path in Path("/dev").glob("video*")))
        found = "no such device, or it is in use, or it is no camera"
        raise SourceError(f"camera {device}", found=found, accepted=present or "none: this machine has no /dev/video*")
    for key, value in (
        (cv2.CAP_PROP_FRAME_WIDTH, width_px),
        (cv2.CAP_PROP_FRAME_HEIGHT, height_px),
        (cv2.CAP_PROP_FPS, rate_hz),
        (cv2.CAP_PROP_BUFFERSIZE, CAMERA_BUFFERS),
    ):
        capture.set(key, value)
    if int(capture.get(cv2.CAP_PROP_FOURCC)) == YUYV:
        capture.set(cv2.CAP_PROP_CONVERT_RGB, 0)  # its buffer as it is: converted once, where it is to go
    return Video(capture)


def distances_to(mask: NDArray[np.bool_]) -> NDArray[np.float32]:
    """Distance of every pixel to the nearest true one [px], same shape; large everywhere when none is true."""
    return cast("NDArray[np.float32]", cv2.distanceTransform((~mask).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_3))


def without_small_regions(mask: NDArray[np.bool_], least_px: int) -> NDArray[np.bool_]:
    """A mask without those of its regions whose boxes are shorter than least_px along both sides."""
    _, labels, boxes, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    is_large = np.maximum(boxes[:, cv2.CC_STAT_WIDTH], boxes[:, cv2.CC_STAT_HEIGHT]) >= least_px
    is_large[0] = False
    return cast("NDArray[np.bool_]", is_large[labels])


def straight_segments(mask: NDArray[np.bool_], least_px: float, gap_px: float, votes: int) -> NDArray[np.float64]:
    """Straight pieces of a mask by a probabilistic Hough transform: x1, y1, x2, y2 [px], shape (n, 4)."""
    cv2.setRNGSeed(1)
    found = cv2.HoughLinesP(mask.astype(np.uint8), 1.0, np.pi / 360.0, votes, None, least_px, gap_px)
    return np.empty((0, 4)) if found is None else np.asarray(found, dtype=np.float64).reshape(-1, 4)

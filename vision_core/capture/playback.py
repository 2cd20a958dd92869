"""Image sources that play files: a picture, a folder of pictures, a video. Each begins again at its end."""

import stat
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from vision_core.clock import Clock, Instant
from vision_core.errors import SourceError
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import HEADER_BYTES, Video, check_picture_size, open_video, read_picture
from vision_core.timing.rate_keeper import Keeper, rate_keeper
from vision_core.user_files import read_bytes

MAX_CACHE_BYTES = 512 * 1024 * 1024
"""Decoded pictures that are kept: a folder plays at any rate without decoding every picture again and again."""
PICTURES = frozenset({".bmp", ".jpeg", ".jpg", ".png", ".tif", ".tiff", ".webp"})
"""Endings of the files of a folder that are played."""
MAX_NAMED = 5
"""Files left out that a source's description names; the rest is counted."""


class Pictures:
    """One picture, or several in turn, at the camera's rate. Implements PlayedSource.

    skipped: files of the folder that are not played, each with its reason. A picture that cannot be read when its
    turn comes is passed over as well.
    """

    repeats = True

    def __init__(
        self,
        paths: Sequence[Path],
        description: str,
        camera: CameraSetup,
        keeper: Keeper,
        skipped: Sequence[str] = (),
    ) -> None:
        self.description = description
        self.skipped = tuple(skipped)
        self.rate_hz = camera.rate_hz
        self._size_px = camera.size_px
        self._paths = paths
        self.keeper: Keeper = keeper
        self._next = 0
        self._cache: dict[tuple[Path, int], Bytes] = {}
        """Decoded pictures by path and time of modification."""
        if len(paths) == 1:
            self._read(paths[0])

    def grab(self, pixels: Bytes) -> Instant:
        """The next picture, as ``ImageSource.grab``. Raises SourceError when none of the pictures can be read."""
        instant = self.keeper.wait()
        problem: SourceError | None = None
        for _ in self._paths:
            path = self._paths[self._next % len(self._paths)]
            self._next += 1
            try:
                np.copyto(pixels, self._picture(path))
            except SourceError as error:
                problem = error
            else:
                return instant
        assert problem is not None
        raise problem

    def _picture(self, path: Path) -> Bytes:
        """A picture as its file is now, from the cache if the file has not changed."""
        try:
            key = path, path.stat().st_mtime_ns
        except OSError:
            return self._read(path)  # raises with the reason
        if key not in self._cache:
            picture = self._read(path)
            if len(self._cache) * picture.nbytes >= MAX_CACHE_BYTES:
                self._cache.clear()
            self._cache[key] = picture
        return self._cache[key]

    def check(self) -> tuple[str, ...]:
        """Decode every picture once; returns the files that are not played, each with its reason.

        Raises SourceError when not one of them can be played.
        """
        problems = []
        for path in self._paths:
            try:
                self._read(path)
            except SourceError as error:
                problems.append(error)
        if len(problems) == len(self._paths):
            raise problems[0]
        return (*self.skipped, *(f"{error.asked}: {error.found}" for error in problems))

    def prepare(self) -> None:
        """Nothing to prepare."""

    def close(self) -> None:
        """No file is held open."""

    def _read(self, path: Path) -> Bytes:
        return read_picture(path, self._size_px)


class VideoPlayback:
    """A video at its own rate, so that what moves keeps its speed: a late reader misses frames.

    Implements PlayedSource. Raises SourceError when no frame can be decoded, or frames have another size.
    """

    repeats = True

    def __init__(self, path: Path, camera: CameraSetup, clock: Clock, *, paced: bool) -> None:
        self._path = path
        self._video = self._open()
        check_size(f"video {path}", (self._video.width_px, self._video.height_px), camera.size_px)
        self.rate_hz = self._video.rate_hz or camera.rate_hz
        self.description = f"video {path.name} at {self.rate_hz:g} Hz, looped"
        self._read_frame(camera.black_image())
        self._rewind()
        self.keeper: Keeper = rate_keeper(self.rate_hz, clock, paced=paced)
        self._shown = -1
        """Number of the frame grabbed last, on the grid of the keeper."""

    def grab(self, pixels: Bytes) -> Instant:
        """The next frame, as ``ImageSource.grab``. Raises SourceError when the file has no frame any more."""
        instant = self.keeper.wait()
        missed = min(self.keeper.number - self._shown - 1, round(self.rate_hz))
        self._shown = self.keeper.number
        for _ in range(missed):
            if not self._video.skip():
                self._rewind()
        if not self._video.read(pixels):
            self._rewind()
            self._read_frame(pixels)
        return instant

    def prepare(self) -> None:
        """Nothing to prepare."""

    def close(self) -> None:
        """Close the file."""
        self._video.close()

    def _read_frame(self, pixels: Bytes) -> None:
        if not self._video.read(pixels):
            found = "no frame that can be decoded"
            raise SourceError(f"video {self._path}", found=found, accepted="a video with at least one frame")

    def _open(self) -> Video:
        return open_video(self._path)

    def _rewind(self) -> None:
        self._video.close()
        self._video = self._open()


def open_file(path: Path, camera: CameraSetup, clock: Clock, *, paced: bool) -> Pictures | VideoPlayback:
    """A picture, a folder of pictures or a video, by the ending of its name.

    Of a folder the pictures of the camera's size are played, in the order of their names; the others are named in the
    description. Raises SourceError when nothing can be played.
    """
    try:
        is_folder = stat.S_ISDIR(path.stat().st_mode)
        files = sorted(path.iterdir()) if is_folder else [path]
    except (OSError, ValueError) as error:  # ValueError: a NUL character in the name
        found = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise SourceError(f"file {path}", found=found, accepted="a picture, a folder or a video") from None
    if not is_folder and path.suffix.lower() not in PICTURES:
        return VideoPlayback(path, camera, clock, paced=paced)
    keeper = rate_keeper(camera.rate_hz, clock, paced=paced)
    if not is_folder:
        return Pictures(files, f"picture {path.name}", camera, keeper)
    reasons = {file: _reason_to_skip(file, camera.size_px) for file in files}
    played = [file for file, reason in reasons.items() if not reason]
    skipped = [f"{file.name}: {reason}" for file, reason in reasons.items() if reason]
    if not played:
        found = f"no picture of this size{_listed(skipped)}"
        accepted = f"{', '.join(sorted(PICTURES))} of {camera.size_px[0]}x{camera.size_px[1]} px"
        raise SourceError(f"folder {path}", found=found, accepted=accepted)
    description = f"{len(played)} pictures of {path.name}, looped{_listed(skipped)}"
    return Pictures(played, description, camera, keeper, skipped)


def _reason_to_skip(file: Path, size_px: tuple[int, int]) -> str:
    """Why a file of a folder is not played, by its name and its first bytes; empty when it is."""
    if file.suffix.lower() not in PICTURES:
        return "no picture"
    asked = f"picture {file}"
    try:
        data = read_bytes(file, asked, SourceError, max_bytes=HEADER_BYTES, only_first=True)
        check_picture_size(asked, data, size_px)
    except SourceError as error:
        return error.found
    return ""


def _listed(skipped: Sequence[str]) -> str:
    if not skipped:
        return ""
    more = f" and {len(skipped) - MAX_NAMED} more" if len(skipped) > MAX_NAMED else ""
    return f"; not played: {', '.join(skipped[:MAX_NAMED])}{more}"


def check_size(asked: str, found_px: tuple[int, int], wanted_px: tuple[int, int]) -> None:
    """Raise SourceError unless width and height [px] are those of the venue: its calibration fits no other."""
    if found_px != wanted_px:
        raise SourceError(
            asked,
            found=f"{found_px[0]}x{found_px[1]} px",
            accepted=f"{wanted_px[0]}x{wanted_px[1]} (camera.width_px, camera.height_px of the venue)",
        )

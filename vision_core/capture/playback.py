"""Images from files: a picture, a folder of pictures, a video. All of them begin again at their end."""

import stat
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from vision_core.clock import Clock, Instant
from vision_core.errors import SourceError
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import Video, open_video, read_picture
from vision_core.timing.rate_keeper import Keeper, rate_keeper

MAX_KEPT = 512 * 1024 * 1024
"""Of decoded pictures [bytes]: a folder is shown at any rate, without decoding it again and again."""
PICTURES = frozenset({".bmp", ".jpeg", ".jpg", ".png", ".tif", ".tiff", ".webp"})


class Pictures:
    """One picture or several in turn, at the camera's rate. Implements Source."""

    repeats = True

    def __init__(self, paths: Sequence[Path], description: str, camera: CameraSetup, keeper: Keeper) -> None:
        self.description = description
        self.rate_hz = camera.rate_hz
        self._size_px = camera.size_px
        self._paths = paths
        self.keeper: Keeper = keeper
        self._next = 0
        self._kept: dict[tuple[Path, int], Bytes] = {}
        self._read(paths[0])

    def grab(self, pixels: Bytes) -> Instant:
        """The next picture, as ``Source.grab``. Raises SourceError when it cannot be read or has another size."""
        instant = self.keeper.wait()
        path = self._paths[self._next % len(self._paths)]
        self._next += 1
        np.copyto(pixels, self._picture(path))
        return instant

    def _picture(self, path: Path) -> Bytes:
        """A picture as its file is now, read once while there is room to keep it."""
        try:
            key = path, path.stat().st_mtime_ns
        except OSError:
            return self._read(path)  # which says why
        if key not in self._kept:
            picture = self._read(path)
            if len(self._kept) * picture.nbytes >= MAX_KEPT:
                self._kept.clear()
            self._kept[key] = picture
        return self._kept[key]

    def check(self) -> None:
        """Read every picture once. Raises SourceError for the first that cannot be read or has another size."""
        for path in self._paths:
            self._read(path)

    def prepare(self) -> None:
        """It is all there."""

    def close(self) -> None:
        """Nothing is held open."""

    def _read(self, path: Path) -> Bytes:
        picture = read_picture(path)
        height, width, _ = picture.shape
        check_size(f"picture {path}", (width, height), self._size_px)
        return picture


class VideoPlayback:
    """A video at its own rate, so that what moves keeps its speed: a late reader misses frames. Implements Source."""

    repeats = True

    def __init__(self, path: Path, camera: CameraSetup, clock: Clock, *, paced: bool) -> None:
        self._path = path
        self._video = self._open()
        check_size(f"video {path}", (self._video.width_px, self._video.height_px), camera.size_px)
        self.rate_hz = self._video.rate_hz or camera.rate_hz
        self.description = f"video {path.name} at {self.rate_hz:g} Hz, looped"
        self.keeper: Keeper = rate_keeper(self.rate_hz, clock, paced=paced)
        self._shown = -1

    def grab(self, pixels: Bytes) -> Instant:
        """The next frame, as ``Source.grab``. Raises SourceError when the file has no frame any more."""
        instant = self.keeper.wait()
        missed = min(self.keeper.number - self._shown - 1, round(self.rate_hz))
        self._shown = self.keeper.number
        for _ in range(missed):
            if not self._video.skip():
                self._rewind()
        if not self._video.read(pixels):
            self._rewind()
            if not self._video.read(pixels):
                raise SourceError(f"video {self._path}", found="no frame that can be decoded", accepted="a video")
        return instant

    def prepare(self) -> None:
        """It is all there."""

    def close(self) -> None:
        """Close the file."""
        self._video.close()

    def _open(self) -> Video:
        return open_video(self._path)

    def _rewind(self) -> None:
        self._video.close()
        self._video = self._open()


def open_file(path: Path, camera: CameraSetup, clock: Clock, *, paced: bool) -> Pictures | VideoPlayback:
    """A picture, a folder or a video. Raises SourceError when there is none, or its size is not the camera's."""
    accepted = "a picture, a folder or a video"
    try:
        mode = path.stat().st_mode
        files = sorted(path.iterdir()) if stat.S_ISDIR(mode) else [path]
    except OSError as error:
        raise SourceError(f"file {path}", found=error.strerror or str(error), accepted=accepted) from None
    if not (stat.S_ISDIR(mode) or stat.S_ISREG(mode)):  # reading a pipe may never end
        raise SourceError(f"file {path}", found="neither a file nor a folder", accepted=accepted)
    pictures = [file for file in files if file.suffix.lower() in PICTURES]
    if not stat.S_ISDIR(mode) and not pictures:
        return VideoPlayback(path, camera, clock, paced=paced)
    if not pictures:
        raise SourceError(f"folder {path}", found="no picture in it", accepted=", ".join(sorted(PICTURES)))
    shown = f"{len(pictures)} pictures of {path.name}, looped" if stat.S_ISDIR(mode) else f"picture {path.name}"
    return Pictures(pictures, shown, camera, rate_keeper(camera.rate_hz, clock, paced=paced))


def check_size(asked: str, found_px: tuple[int, int], wanted_px: tuple[int, int]) -> None:
    """Raise SourceError unless width and height [px] are those of the venue: its calibration fits no other."""
    if found_px != wanted_px:
        raise SourceError(
            asked,
            found=f"{found_px[0]}x{found_px[1]} px",
            accepted=f"{wanted_px[0]}x{wanted_px[1]} (camera.width_px, camera.height_px of the venue)",
        )

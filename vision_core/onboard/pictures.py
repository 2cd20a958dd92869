"""On-board pictures from files: of any size, one after the other, each once."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from vision_core.capture.playback import PICTURES
from vision_core.errors import SourceError
from vision_core.geometry import Bytes
from vision_core.native.opencv import open_video, read_picture


def open_pictures(path: Path) -> Iterator[Bytes]:
    """The pictures of a file, of a folder in the order of names, or of a video: blue green red.

    Raises SourceError when there is nothing that can be read; a later picture of a folder raises when its turn comes.
    """
    if path.is_dir():
        files = sorted(file for file in path.iterdir() if file.suffix.lower() in PICTURES)
        if not files:
            raise SourceError(f"folder {path}", found="no picture", accepted=", ".join(sorted(PICTURES)))
        return map(read_picture, files)
    if path.suffix.lower() in PICTURES:
        return iter([read_picture(path)])
    return _frames(path)


def _frames(path: Path) -> Iterator[Bytes]:
    video = open_video(path)
    try:
        while True:
            frame = np.empty((video.height_px, video.width_px, 3), dtype=np.uint8)
            if not video.read(frame):
                return
            yield frame
    finally:
        video.close()

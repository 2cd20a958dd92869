"""The newest image, copied: every tracker that takes longer than a frame looks at memory of its own.

A copy that the camera overtook is thrown away and noticed: three times in a row, and the release is missed.
"""

import numpy as np

from vision_core.clock import Instant
from vision_core.rtdb.slots import READ_TRIES
from vision_core.scheduling.handle import Handle
from vision_core.scheduling.releases import Release
from vision_core.types.image import ImageFrame

SOON_S = 1.0
"""An image older than this is none: nobody is told about a field of long ago."""


class Images:
    """The images of the service's camera, for one task."""

    def __init__(self, handle: Handle) -> None:
        camera = handle.camera
        self._camera = camera.name
        self._handle = handle
        self._frames = handle.raw_reader(f"frames/{camera.name}")
        self._copy = camera.black_image()
        self.overtaken = 0
        """Copies that were thrown away."""

    def newest(self, release: Release) -> ImageFrame | None:
        """A copy of the newest image, in the same memory each time; None when there is none of late.

        release: told that it is missed when there was an image, and every copy was overtaken.
        """
        flat, before = self._copy.reshape(-1), self.overtaken
        for _ in range(READ_TRIES):
            view = self._frames.view()
            if view is None or self._handle.clock.now() - view.measured > SOON_S * 1e9:
                continue
            np.copyto(flat, np.frombuffer(view.payload, dtype=np.uint8))
            if self._frames.is_unchanged(view):
                return ImageFrame(self._camera, view.sequence, Instant(view.measured), self._copy)
            self.overtaken += 1
            self._handle.note = f"the camera overtook {self.overtaken} copies of its images"
        release.missed += self.overtaken > before
        return None

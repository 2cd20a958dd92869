"""The newest image, copied: every task that looks at an image for longer than a frame has a copy of its own.

A copy that the camera overwrote meanwhile is thrown away and made again; after three such copies the release is missed.
"""

import numpy as np

from vision_core.clock import NS_PER_S, Instant
from vision_core.rtdb.slots import READ_TRIES
from vision_core.scheduling.handle import Handle
from vision_core.scheduling.releases import StepResult
from vision_core.types.image import ImageFrame

MAX_AGE_S = 1.0
"""An older image is ignored: the camera has stopped."""


class Images:
    """The images of the service's camera, for one task."""

    def __init__(self, handle: Handle) -> None:
        camera = handle.camera
        self._camera = camera.name
        self._handle = handle
        self._frames = handle.raw_reader(f"frames/{camera.name}")
        self._copy = camera.black_image()
        self._overwritten = 0
        """Copies that were thrown away."""
        self._missed = 0
        """1: the last call of ``newest`` found an image, but every copy was overwritten."""

    @property
    def none_result(self) -> StepResult:
        """What a step returns when ``newest`` has returned None."""
        return StepResult(ran=False, missed=self._missed)

    def newest(self) -> ImageFrame | None:
        """A copy of the newest image, in the same memory each time; None when there is none younger than MAX_AGE_S."""
        flat, self._missed = self._copy.reshape(-1), 0
        for _ in range(READ_TRIES):
            view = self._frames.view()
            if view is None or self._handle.clock.now() - view.measured > MAX_AGE_S * NS_PER_S:
                continue
            np.copyto(flat, np.frombuffer(view.payload, dtype=np.uint8))
            if self._frames.is_unchanged(view):
                self._missed = 0
                return ImageFrame(self._camera, view.sequence, Instant(view.measured), self._copy)
            self._overwritten, self._missed = self._overwritten + 1, 1
            self._handle.note = f"the camera overwrote {self._overwritten} images while they were copied"
        return None

"""A camera of this machine, through OpenCV and Video4Linux.

Not yet tried on hardware by its authors: what can be tested without a camera is tested, the rest follows OpenCV's
documentation. OpenCV gives up waiting for a camera that stops delivering after 2 s; the age of the last image shows it
much earlier.
"""

from vision_core.capture.devices import device_path
from vision_core.capture.playback import check_size
from vision_core.clock import NS_PER_MS, NS_PER_S, Clock, Instant
from vision_core.errors import SourceError
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import open_camera

OLDEST_STAMP_NS = NS_PER_S
"""A driver's time stamp that is older than this is taken for one of another clock."""
STAMP_ROUNDING_NS = NS_PER_MS
"""A time stamp may lie this far in the future: OpenCV gives it in milliseconds."""


class DeviceCamera:
    """A V4L2 camera at the size and rate of the venue. Implements ImageSource.

    Raises SourceError when it does not open, delivers no image, or has another size.
    """

    repeats = False

    def __init__(self, device: str, camera: CameraSetup, clock: Clock) -> None:
        self._size_px = camera.size_px
        self._device = device
        self._clock = clock
        self._last = clock.now()
        self._video = open_camera(device_path(device), *camera.size_px, camera.rate_hz)
        self.rate_hz = self._video.rate_hz or camera.rate_hz
        try:
            check_size(f"camera {device}", (self._video.width_px, self._video.height_px), self._size_px)
            self.grab(camera.black_image())
        except SourceError:
            self.close()
            raise
        stamped = driver_instant(self._video.position_ms(), clock.now()) is not None
        by = "the driver" if stamped else "our own clock after the grab: the driver gives none"
        self.description = f"camera {device}, instants by {by}"

    def grab(self, pixels: Bytes) -> Instant:
        """The next image, as ``ImageSource.grab``. Raises SourceError when none comes."""
        if not self._video.read(pixels):
            raise SourceError(
                f"camera {self._device}",
                found="no image, or one of another size",
                accepted=f"images of {self._size_px[0]}x{self._size_px[1]}",
            )
        now = self._clock.now()
        stamp = driver_instant(self._video.position_ms(), now) or now
        self._last = Instant(max(stamp, self._last + 1))
        return self._last

    def close(self) -> None:
        """Release the device."""
        self._video.close()


def driver_instant(stamp_ms: float, now: Instant) -> Instant | None:
    """The instant of a driver's time stamp [ms], or None when the stamp is not of our clock.

    Linux stamps buffers by CLOCK_MONOTONIC, which is our clock. Some drivers use the wall clock or count from zero: a
    stamp that is older than a second or lies in the future is rejected.
    """
    stamp = round(stamp_ms * NS_PER_MS)
    if now - OLDEST_STAMP_NS <= stamp <= now:
        return Instant(stamp)
    return now if now < stamp <= now + STAMP_ROUNDING_NS else None

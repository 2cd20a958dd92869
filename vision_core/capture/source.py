"""What a source of images is, and which one an address means."""

from pathlib import Path
from typing import Protocol

from vision_core.clock import Clock, Instant
from vision_core.errors import SourceError
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.settings.schema import Settings
from vision_core.timing.rate_keeper import Keeper

DEVICE = "camera"
ACCEPTED = "synthetic, file:<picture, folder or video>, camera:<number or path of the device>"


class Source(Protocol):
    """Delivers images of one size, one after the other."""

    description: str
    """What status shows, "synthetic, seed 1"."""
    repeats: bool
    """Shows the same again by nature (a still, a looped video): no sign of a frozen camera."""
    rate_hz: float

    def grab(self, pixels: Bytes) -> Instant:
        """Wait for the next image, write it into pixels, and return when it was grabbed.

        pixels: shape (height, width, 3), blue green red; a place in shared memory that is the source's only
        during the call. Instants strictly increase. Raises SourceError when the source is gone.
        """
        ...

    def close(self) -> None:
        """Give the device or file back."""
        ...


class Played(Source, Protocol):
    """A source that is no device: it shows what it is asked for, when it is asked."""

    keeper: Keeper
    """Says when the next image is due; who orders images puts one of his own in its place."""

    def prepare(self) -> None:
        """Make whatever the first image would have to wait for."""
        ...


def is_device(settings: Settings) -> bool:
    """Does ``source.uri`` name a camera, which delivers by itself?"""
    kind, _, device = settings.source.uri.partition(":")
    return kind == DEVICE and bool(device)


def open_source(settings: Settings, camera: CameraSetup, clock: Clock, *, paced: bool = True) -> Source:
    """The source that ``source.uri`` names.

    paced: in real time; otherwise files and the simulated camera deliver as fast as they are asked, at the
    instants of a virtual clock that starts now. Raises SourceError when the address means nothing, the
    device or file cannot be opened, or its size is not the camera's.
    """
    if is_device(settings):
        from vision_core.capture.camera import DeviceCamera

        return DeviceCamera(settings.source.uri.partition(":")[2], camera, clock)
    return open_played(settings, camera, clock, paced=paced)


def open_played(settings: Settings, camera: CameraSetup, clock: Clock, *, paced: bool) -> Played:
    """The simulated camera or the files that ``source.uri`` names; as ``open_source``."""
    uri = settings.source.uri
    kind, _, rest = uri.partition(":")
    # each kind brings its own libraries: a camera needs no compiler, a simulation no codecs
    if uri == "synthetic":
        from vision_core.capture.synthetic.camera import SyntheticCamera

        return SyntheticCamera(settings, camera, clock, paced=paced)
    if kind == "file" and rest:
        from vision_core.capture.playback import open_file

        return open_file(Path(rest), camera, clock, paced=paced)
    raise SourceError("source.uri", found=repr(uri), accepted=ACCEPTED)

"""The interface of image sources, and the choice of one by its address ``source.uri``."""

from pathlib import Path
from typing import Protocol

from vision_core.clock import Clock, Instant
from vision_core.errors import SourceError
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.settings.schema import SYNTHETIC, Settings
from vision_core.timing.rate_keeper import Keeper

ACCEPTED = "synthetic, file:<picture, folder or video>, camera:<number or path of the device, name=... or serial=...>"


class ImageSource(Protocol):
    """Delivers images of one size, one after the other."""

    description: str
    """For people: "synthetic, seed 1"."""
    repeats: bool
    """Does it show the same images again by nature (a still, a looped video)? Then equal images are no sign of a frozen
    camera."""
    rate_hz: float
    """Images per second."""

    def grab(self, pixels: Bytes) -> Instant:
        """Wait for the next image, write it into pixels, and return when it was grabbed.

        pixels: shape (height, width, 3), blue green red; memory shared with other processes, which the source writes
        during the call only. Instants strictly increase. Raises SourceError when no more images can come.
        """
        ...

    def close(self) -> None:
        """Release the device or file."""
        ...


class PlayedSource(ImageSource, Protocol):
    """A source that is no device: it makes an image when one is requested."""

    keeper: Keeper
    """Determines when the next image is due; the task that requests images replaces it by its own."""

    def prepare(self) -> None:
        """Compute what the first image needs, so that the first ``grab`` takes no longer than others."""
        ...


def open_source(settings: Settings, camera: CameraSetup, clock: Clock, *, paced: bool = True) -> ImageSource:
    """The source that ``source.uri`` names.

    paced: in real time; otherwise files and the simulated camera deliver as fast as they are asked, at the instants of
    a virtual clock that starts now. Raises SourceError when the address means nothing, the device or file cannot be
    opened, or its size is not the camera's.
    """
    device = settings.source.device
    if device is not None:
        from vision_core.capture.camera import DeviceCamera

        return DeviceCamera(device, camera, clock)
    return open_played(settings, camera, clock, paced=paced)


def open_played(settings: Settings, camera: CameraSetup, clock: Clock, *, paced: bool) -> PlayedSource:
    """The simulated camera or the files that ``source.uri`` names; parameters and errors as of ``open_source``."""
    uri = settings.source.uri
    kind, _, rest = uri.partition(":")
    # each kind imports its own libraries: a camera needs no compiler, a simulation no codecs
    if uri == SYNTHETIC:
        from vision_core.capture.synthetic.camera import SyntheticCamera

        return SyntheticCamera(settings, camera, clock, paced=paced)
    if kind == "file" and rest:
        from vision_core.capture.playback import open_file

        return open_file(Path(rest), camera, clock, paced=paced)
    raise SourceError("source.uri", found=repr(uri), accepted=ACCEPTED)

"""Which device file a camera has that is called by number, path, name or serial number.

Numbers of V4L2 devices follow the order of plugging in, so a venue with two cameras names them: ``camera:name=C920`` or
``camera:serial=7A5C11EF``. Both are read from the kernel (sysfs), so that a container without udev has them too. A
camera has further device files for its metadata; only the first of each camera counts.
"""

from dataclasses import dataclass
from pathlib import Path

from vision_core.errors import SourceError

SYSFS = Path("/sys/class/video4linux")


@dataclass(frozen=True)
class Device:
    """A camera of this machine."""

    path: str
    """Its device file."""
    name: str
    serial: str
    """Of the USB device; empty when it tells none."""

    def __str__(self) -> str:
        """For a list to choose from: name=HD Pro Webcam serial=7A5C11EF (/dev/video0)."""
        serial = f" serial={self.serial}" if self.serial else ""
        return f"name={self.name}{serial} ({self.path})"


def device_path(device: str, sysfs: Path = SYSFS) -> str:
    """The device file of a camera. device: "0", "/dev/video0", "name=C920" (any part, in any case) or "serial=7A5C".

    Raises SourceError, which lists the cameras that are there, when no camera or more than one answers to it.
    """
    if device.isdecimal():
        return f"/dev/video{device}"
    key, is_given, wanted = device.partition("=")
    if not is_given or key not in ("name", "serial"):
        return device
    present = devices(sysfs)
    if key == "serial":
        matching = [one for one in present if wanted and one.serial == wanted]
    else:
        matching = [one for one in present if wanted and wanted.casefold() in one.name.casefold()]
    if len(matching) == 1:
        return matching[0].path
    found = f"{len(matching)} cameras: {_listed(matching)}" if matching else "no such camera"
    raise SourceError(f"camera {device}", found=found, accepted=_listed(present) or "none: this machine has no camera")


def devices(sysfs: Path = SYSFS) -> list[Device]:
    """The cameras of this machine by device number; one that is unplugged meanwhile is left out."""
    nodes = sorted(sysfs.glob("video*"), key=lambda node: (len(node.name), node.name))
    return [
        Device(f"/dev/{node.name}", name, _text(_usb_device(node) / "serial"))
        for node in nodes
        if _text(node / "index") in ("", "0") and (name := _text(node / "name"))
    ]


def _usb_device(node: Path) -> Path:
    """The directory of the USB device: the parent of the interface that the node's ``device`` leads to."""
    return (node / "device").resolve().parent


def _text(path: Path) -> str:
    """A kernel's file of one line; empty when there is none."""
    try:
        return path.read_text(errors="replace").strip()
    except OSError:
        return ""


def _listed(cameras: list[Device]) -> str:
    return ", ".join(map(str, cameras))

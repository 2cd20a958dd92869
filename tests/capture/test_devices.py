"""A camera by its name or serial number is one device file, or the error lists the cameras that are there."""

from pathlib import Path

import pytest

from vision_core.capture.devices import device_path, devices
from vision_core.errors import SourceError


@pytest.fixture
def sysfs(tmp_path: Path) -> Path:
    """Two cameras of one make, each with a second file for metadata, and one that tells no serial number."""
    folder = tmp_path / "video4linux"
    for number, index, name, usb, serial in (
        (0, 0, "HD Pro Webcam C920", "1-1", "7A5C11EF"),
        (1, 1, "HD Pro Webcam C920", "1-1", "7A5C11EF"),
        (2, 0, "HD Pro Webcam C920", "1-2", "99B0D2AF"),
        (3, 1, "HD Pro Webcam C920", "1-2", "99B0D2AF"),
        (10, 0, "Global Shutter: USB 3", "2-1", ""),
    ):
        interface = tmp_path / "usb" / usb / f"{usb}:1.0"
        interface.mkdir(parents=True, exist_ok=True)
        if serial:
            (interface.parent / "serial").write_text(f"{serial}\n")
        node = folder / f"video{number}"
        node.mkdir(parents=True)
        (node / "name").write_text(f"{name}\n")
        (node / "index").write_text(f"{index}\n")
        (node / "device").symlink_to(interface)
    return folder


def test_each_camera_counts_once_and_in_order(sysfs: Path) -> None:
    assert [one.path for one in devices(sysfs)] == ["/dev/video0", "/dev/video2", "/dev/video10"]


@pytest.mark.parametrize(
    ("device", "path"),
    [
        ("0", "/dev/video0"),
        ("/dev/video7", "/dev/video7"),
        ("/dev/name=x", "/dev/name=x"),
        ("serial=99B0D2AF", "/dev/video2"),
        ("name=global shutter", "/dev/video10"),
        ("name=Global Shutter: USB 3", "/dev/video10"),
    ],
)
def test_a_camera_is_one_device_file(sysfs: Path, device: str, path: str) -> None:
    assert device_path(device, sysfs) == path


@pytest.mark.parametrize("device", ["serial=7A5C", "serial=", "name=", "name=BRIO"])
def test_a_missing_camera_is_answered_by_those_that_are_there(sysfs: Path, device: str) -> None:
    with pytest.raises(SourceError, match="no such camera") as caught:
        device_path(device, sysfs)
    assert "name=HD Pro Webcam C920 serial=99B0D2AF (/dev/video2)" in caught.value.accepted
    assert "name=Global Shutter: USB 3 (/dev/video10)" in caught.value.accepted


def test_a_name_of_two_cameras_names_both(sysfs: Path) -> None:
    with pytest.raises(SourceError, match="2 cameras") as caught:
        device_path("name=C920", sysfs)
    assert "serial=7A5C11EF" in caught.value.found
    assert "serial=99B0D2AF" in caught.value.found


def test_a_machine_without_cameras_says_so(tmp_path: Path) -> None:
    with pytest.raises(SourceError, match="this machine has no camera"):
        device_path("name=C920", tmp_path)

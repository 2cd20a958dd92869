"""Files: the right picture at the right time, again from the beginning, and errors that help."""

import os
import struct
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest

from vision_core.capture.playback import Pictures
from vision_core.capture.source import ImageSource, open_source
from vision_core.clock import NS_PER_S, ManualClock
from vision_core.errors import SourceError
from vision_core.geometry import Bytes
from vision_core.models.camera_setup import CameraSetup
from vision_core.native.opencv import write_picture
from vision_core.venues.loader import load_settings

WIDTH, HEIGHT = 96, 64
SMALL = {
    "camera.width_px": WIDTH,
    "camera.height_px": HEIGHT,
    "camera.pinhole.focal_px": 100.0,
    "camera.pinhole.center_px": [48.0, 32.0],
}


def opened(path: Path) -> ImageSource:
    options = {"source.uri": f"file:{path}", **SMALL}
    settings = load_settings(options=options)
    return open_source(settings, CameraSetup.from_settings(settings), ManualClock(), paced=False)


def plain(level: int, width: int = WIDTH) -> Bytes:
    return np.full((HEIGHT, width, 3), level, dtype=np.uint8)


def levels(source: ImageSource, count: int) -> list[int]:
    pixels = plain(0)
    found = []
    for _ in range(count):
        source.grab(pixels)
        found.append(round(float(pixels.mean())))
    return found


def write_video(path: Path, shades: list[int]) -> None:
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 10.0, (WIDTH, HEIGHT))
    for shade in shades:
        writer.write(plain(shade))
    writer.release()


def test_a_still_repeats_at_the_cameras_rate(tmp_path: Path) -> None:
    write_picture(tmp_path / "still.png", plain(77))
    source = opened(tmp_path / "still.png")
    pixels = plain(0)
    instants = [source.grab(pixels) for _ in range(3)]
    assert (pixels == 77).all()
    assert np.diff(instants).tolist() == pytest.approx([NS_PER_S / 30.0] * 2, abs=1.0)
    assert source.repeats
    assert source.description == "picture still.png"


def test_a_folder_is_shown_in_order_and_again(tmp_path: Path) -> None:
    for name, level in (("b.png", 20), ("a.png", 10), ("c.PNG", 30)):
        write_picture(tmp_path / name.lower(), plain(level))
        (tmp_path / name.lower()).rename(tmp_path / name)
    (tmp_path / "truth.json").write_text("{}")
    source = opened(tmp_path)
    assert levels(source, 7) == [10, 20, 30, 10, 20, 30, 10]
    assert source.repeats
    assert "3 pictures" in source.description


def test_a_video_keeps_its_own_rate_and_loops(tmp_path: Path) -> None:
    write_video(tmp_path / "play.avi", [40, 80, 120, 160])
    source = opened(tmp_path / "play.avi")
    assert source.rate_hz == pytest.approx(10.0)
    assert levels(source, 9) == pytest.approx([40, 80, 120, 160, 40, 80, 120, 160, 40], abs=2)
    source.close()


def test_a_late_reader_misses_frames_of_a_video(tmp_path: Path) -> None:
    write_video(tmp_path / "play.avi", [40, 80, 120, 160])
    clock = ManualClock()
    options = {
        "source.uri": f"file:{tmp_path / 'play.avi'}", **SMALL,
    }  # fmt: skip
    source = open_source(
        load_settings(options=options), CameraSetup.from_settings(load_settings(options=options)), clock
    )
    assert levels(source, 1) == pytest.approx([40], abs=2)
    clock.advance(0.2)
    assert levels(source, 1) == pytest.approx([120], abs=2)
    source.close()


def test_another_size_than_the_venues_is_refused_and_both_are_named(tmp_path: Path) -> None:
    write_picture(tmp_path / "wide.png", plain(0, width=100))
    with pytest.raises(SourceError, match="wide.png") as caught:
        opened(tmp_path / "wide.png")
    assert caught.value.found == "100x64 px"
    assert caught.value.accepted.startswith("96x64")


def test_of_a_folder_the_pictures_of_the_cameras_size_are_played_and_the_others_are_named(tmp_path: Path) -> None:
    write_picture(tmp_path / "a.png", plain(10))
    write_picture(tmp_path / "b.png", plain(20, width=100))
    write_picture(tmp_path / "c.png", plain(30))
    (tmp_path / "notes.txt").write_text("hello")
    os.mkfifo(tmp_path / "pipe.png")
    source = opened(tmp_path)
    assert isinstance(source, Pictures)
    assert levels(source, 4) == [10, 30, 10, 30]
    said = "not played: b.png: 100x64 px, notes.txt: no picture, pipe.png: a FIFO"
    assert source.description == f"2 pictures of {tmp_path.name}, looped; {said}"
    assert source.check() == ("b.png: 100x64 px", "notes.txt: no picture", "pipe.png: a FIFO")


def test_of_many_files_that_are_not_played_some_are_named_and_all_are_counted(tmp_path: Path) -> None:
    write_picture(tmp_path / "a.png", plain(10))
    for number in range(8):
        (tmp_path / f"{number}.txt").touch()
    assert opened(tmp_path).description.endswith("3.txt: no picture, 4.txt: no picture and 3 more")


def test_a_damaged_picture_of_a_folder_is_passed_over_and_said_by_the_check(tmp_path: Path) -> None:
    for name, level in (("a.png", 10), ("b.png", 20), ("c.png", 30)):
        write_picture(tmp_path / name, plain(level))
    (tmp_path / "b.png").write_bytes((tmp_path / "b.png").read_bytes()[:40])
    source = opened(tmp_path)
    assert isinstance(source, Pictures)
    assert source.check() == (f"picture {tmp_path / 'b.png'}: a damaged picture",)
    assert levels(source, 4) == [10, 30, 10, 30]
    for name in ("a.png", "c.png"):
        (tmp_path / name).unlink()
    with pytest.raises(SourceError, match=r"a\.png; found: No such file"):
        source.check()
    with pytest.raises(SourceError):
        levels(source, 1)


def test_a_folder_of_other_sizes_alone_is_refused(tmp_path: Path) -> None:
    write_picture(tmp_path / "a.png", plain(10, width=100))
    with pytest.raises(
        SourceError, match=r"no picture of this size; not played: a.png: 100x64 px; accepted: .* of 96x64 px"
    ):
        opened(tmp_path)


def test_a_video_without_frames_is_refused(tmp_path: Path) -> None:
    write_video(tmp_path / "zero.avi", [])
    with pytest.raises(SourceError, match=r"video .*zero\.avi; found: "):
        opened(tmp_path / "zero.avi")


@pytest.mark.parametrize("name", ["empty.png", "broken.jpg", "broken.mp4", "notes.txt"])
def test_what_is_no_picture_is_refused_by_name(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(b"" if name.startswith("empty") else b"no image at all")
    with pytest.raises(SourceError, match=name):
        opened(tmp_path / name)


def test_a_missing_file_and_an_empty_folder_are_refused(tmp_path: Path) -> None:
    with pytest.raises(SourceError, match="No such file"):
        opened(tmp_path / "absent.png")
    with pytest.raises(SourceError, match="no picture of this size"):
        opened(tmp_path)


def test_a_name_that_is_too_long_and_a_pipe_are_no_sources(tmp_path: Path) -> None:
    with pytest.raises(SourceError, match="File name too long"):
        opened(tmp_path / ("x" * 300))
    os.mkfifo(tmp_path / "pipe.png")
    with pytest.raises(SourceError, match="found: a FIFO"):
        opened(tmp_path / "pipe.png")


def test_a_picture_that_claims_a_gigantic_size_is_damaged(tmp_path: Path) -> None:
    write_picture(tmp_path / "bomb.png", plain(0))
    data = bytearray((tmp_path / "bomb.png").read_bytes())
    data[16:24] = struct.pack(">II", 100_000, 100_000)  # width and height
    data[29:33] = struct.pack(">I", zlib.crc32(data[12:29]))
    (tmp_path / "bomb.png").write_bytes(data)
    with pytest.raises(SourceError, match="found: 100000x100000 px"):
        opened(tmp_path / "bomb.png")

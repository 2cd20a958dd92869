"""PSLV as a camera: pictures that are recognized as the views that were sent, and what a camera's program may ask."""

import itertools
from collections.abc import Iterator

import numpy as np
import pytest

from tests.client.fake import ScriptedServer
from tests.net.serving import Stadium, playing
from vision_core.client.camera import (
    CAP_PROP_FPS,
    CAP_PROP_FRAME_HEIGHT,
    CAP_PROP_FRAME_WIDTH,
    CAP_PROP_POS_MSEC,
    Camera,
)
from vision_core.client.recognition import DRAWN, paper_geometry, recognize
from vision_core.models.mirror import PAPER_MIRROR

HOST = "127.0.0.1"


@pytest.fixture(scope="module")
def stadium() -> Iterator[Stadium]:
    with playing(Stadium()) as opened:
        yield opened


@pytest.fixture
def camera(stadium: Stadium) -> Iterator[Camera]:
    opened = Camera(HOST, stadium.port, "blue", 3)
    yield opened
    opened.release()


def test_its_pictures_show_what_was_sent(camera: Camera) -> None:
    assert camera.isOpened()
    ok, picture = camera.read()
    assert ok
    assert picture is not None
    assert picture.shape == (240, 320, 3)
    assert picture.dtype == np.uint8
    assert picture.flags.c_contiguous
    seen = recognize(picture, paper_geometry(PAPER_MIRROR), DRAWN)
    assert set(seen.letters.tolist()) == {"w"}
    assert np.abs(seen.px - 0x2C).max() <= 1
    assert camera.view is not None
    assert (camera.view.ball.px, camera.view.ball.direction_deg) == (61, 121)


def test_every_picture_is_newer(camera: Camera) -> None:
    times = []
    for _ in range(4):
        assert camera.grab()
        times.append(camera.get(CAP_PROP_POS_MSEC))
    assert all(later > earlier for earlier, later in itertools.pairwise(times))
    assert camera.retrieve()[0]


def test_properties(camera: Camera) -> None:
    assert (camera.get(CAP_PROP_FRAME_WIDTH), camera.get(CAP_PROP_FRAME_HEIGHT)) == (320.0, 240.0)
    assert camera.get(CAP_PROP_FPS) == 0.0  # not known yet
    for _ in range(3):
        camera.grab()
    assert camera.get(CAP_PROP_FPS) > 5.0
    assert camera.get(38) == 0.0
    assert camera.set(CAP_PROP_FRAME_WIDTH, 320)
    assert not camera.set(CAP_PROP_FRAME_WIDTH, 640)
    assert not camera.set(CAP_PROP_FPS, 0)
    assert camera.set(CAP_PROP_FPS, 20)
    assert camera.get(CAP_PROP_FPS) == 20.0
    times = [camera.get(CAP_PROP_POS_MSEC) for _ in range(5) if camera.grab()]
    assert times[-1] - times[0] > 140.0  # of the images that the views show; without it they are 10 ms apart


def test_after_release_it_says_no(camera: Camera) -> None:
    camera.release()
    assert not camera.isOpened()
    assert camera.read() == (False, None)
    assert camera.retrieve() == (False, None)


def test_the_numbers_are_opencvs() -> None:
    cv2 = pytest.importorskip("cv2")
    for name in ("CAP_PROP_POS_MSEC", "CAP_PROP_FRAME_WIDTH", "CAP_PROP_FRAME_HEIGHT", "CAP_PROP_FPS"):
        assert getattr(cv2, name) == globals()[name]


def test_what_is_refused_is_not_opened_and_says_why(stadium: Stadium, caplog: pytest.LogCaptureFixture) -> None:
    assert not Camera(HOST, stadium.port, "blue", 6).isOpened()
    assert "illegal_number" in caplog.text
    assert not Camera(HOST, stadium.port, "green", 1).isOpened()
    assert "green" in caplog.text


def test_without_a_view_in_time_there_is_no_picture(caplog: pytest.LogCaptureFixture) -> None:
    mirror = b"(ok mirror 4.0187 0.0125935 90000.0)"
    with ScriptedServer(lambda data: [b"(init blue 3 play_on)", mirror] if data.startswith(b"(init") else []) as server:
        camera = Camera(HOST, server.port, "blue", 3, mirror=PAPER_MIRROR, timeout_s=0.3)
        assert camera.isOpened()
        assert camera.read() == (False, None)
        assert camera.isOpened()
        camera.release()
    assert "no view within 0.3 s" in caplog.text


def test_a_session_that_the_server_ends_is_closed(caplog: pytest.LogCaptureFixture) -> None:
    answers = [b"(init blue 3 play_on)", b"(error replaced)"]
    with ScriptedServer(lambda data: answers if data.startswith(b"(init") else []) as server:
        camera = Camera(HOST, server.port, "blue", 3, mirror=PAPER_MIRROR, timeout_s=1.0)
        assert camera.read() == (False, None)
        assert not camera.isOpened()
    assert "replaced" in caplog.text

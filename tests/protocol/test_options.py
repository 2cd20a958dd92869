"""What a client may ask for."""

import math

import numpy as np
import pytest

from vision_core.models.mirror import PAPER_MIRROR
from vision_core.protocol.commands import decode_commands
from vision_core.protocol.error_codes import ErrorCode
from vision_core.protocol.messages import Init, InvalidCommand
from vision_core.protocol.options import (
    MAX_DATAGRAM,
    MAX_DIRECTIONS,
    PAPER_OPTIONS,
    SEE_OVERHEAD,
    Options,
    directions_deg,
    ray_indices,
)


def asked(option: str) -> Options | ErrorCode:
    request = decode_commands(f"(init blue 3 {option})".encode())
    assert request is not None
    command = request.commands[0]
    assert isinstance(command, Init | InvalidCommand)
    return command.options if isinstance(command, Init) else command.error


@pytest.mark.parametrize(
    ("option", "expected"),
    [
        ("(types number)", Options(types="number")),
        ("(mirror 4.0187 0.0125935 9e4)", Options(mirror=PAPER_MIRROR)),
        ("(fov 90)", Options(fov_deg=90.0, center_deg=0.0)),
        ("(fov 360)", PAPER_OPTIONS),
        ("(fov 120 -30.5)", Options(fov_deg=120.0, center_deg=-30.5)),
        ("(resolution 2)", Options(resolution_deg=2.0)),
        ("(fov 100)(resolution 0.25)", Options(fov_deg=100.0, center_deg=0.0, resolution_deg=0.25)),
        ("(rate 10)", Options(rate_hz=10)),
        ("(time us)", Options(time="us")),
        ("(size half)", Options(size="half")),
        ("(sense cw)", Options(sense="cw")),
        ("(port same)", Options(port_same=True)),
        ("(VERSION 7)", Options(version=7)),
    ],
)
def test_each_option(option: str, expected: Options) -> None:
    assert asked(option) == expected


@pytest.mark.parametrize(
    "option",
    [
        "(version 0)",
        "(version -2)",
        "(version)",
        "(types)",
        "(types same team)",
        "(types (same))",
        "(fov)",
        "(fov 0)",
        "(fov -90)",
        "(fov 361)",
        "(fov nan)",
        "(fov 90 inf)",
        "(fov 90 1e999)",
        "(fov 90 0 0)",
        "(fov 90.1)",
        "(resolution 0)",
        "(resolution 0.1)",
        "(resolution 0.5)",
        "(resolution 361)",
        "(fov 90)(resolution 91)",
        "(rate 0)",
        "(rate 1001)",
        "(rate 2.5)",
        "(time ns)",
        "(size double)",
        "(sense left)",
        "(port other)",
        "(port same same)",
        "(types same)(types same)",
        "()",
        "((types same))",
        "(colour red)",
        "types",
    ],
)
def test_illegal_options(option: str) -> None:
    assert asked(option) is ErrorCode.ILLEGAL_OPTION


@pytest.mark.parametrize(
    "constants",
    [
        "",
        "4 0.0126",
        "4 0.0126 90000 1",
        "nan 0.01 90000",
        "inf 0.01 90000",
        "4 0.01 1e999",
        "-4 0.0126 90000",
        "4 0 90000",
        "4 -0.01 90000",
        "1 0.0126 90000",
        "4 0.0126 0",
        "1e200 1e198 100",
        "1e-300 1e-302 100",
        "1e300 1e-300 1",
        "4 (0.0126) 90000",
    ],
)
def test_illegal_mirrors(constants: str) -> None:
    assert asked(f"(mirror {constants})") is ErrorCode.ILLEGAL_MIRROR


def test_the_largest_see_fits() -> None:
    assert SEE_OVERHEAD + 3 * MAX_DIRECTIONS <= MAX_DATAGRAM < SEE_OVERHEAD + 3 * (MAX_DIRECTIONS + 1)
    assert asked("(fov 112)(resolution 0.25)") != ErrorCode.ILLEGAL_OPTION  # 448 directions
    assert asked("(fov 113)(resolution 0.25)") is ErrorCode.ILLEGAL_OPTION


def test_the_papers_directions_are_the_rays() -> None:
    assert ray_indices(PAPER_OPTIONS, 360) is None
    assert np.array_equal(directions_deg(PAPER_OPTIONS, 360), np.arange(360.0))


@pytest.mark.parametrize("sense", ["ccw", "cw"])
@pytest.mark.parametrize(
    ("fov", "center", "step"), [(360.0, 180.0, 1.0), (90.0, 0.0, 2.0), (91.0, 10.0, 1.0), (60.0, -45.25, 0.25)]
)
def test_directions_are_the_rays_they_name(fov: float, center: float, step: float, sense: str) -> None:
    options = Options(fov_deg=fov, center_deg=center, resolution_deg=step, sense=sense)
    rays = options.rays_per_circle
    indices = ray_indices(options, rays)
    chosen = np.arange(rays) if indices is None else indices
    named = directions_deg(options, options.directions)
    expected = [(center - fov / 2 + i * step) % 360 for i in range(math.floor(fov / step))]
    assert named.tolist() == expected
    turned = chosen * (360.0 / rays)
    assert np.array_equal(turned if sense == "ccw" else -turned % 360.0, named)


def test_a_view_without_the_rays_is_our_own_mistake() -> None:
    with pytest.raises(ValueError, match="360 rays"):
        ray_indices(Options(fov_deg=60.0, resolution_deg=0.5), 360)

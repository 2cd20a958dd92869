"""Rendered pictures of a ChArUco board in somebody's hands, by a camera with a known lens."""

from collections.abc import Sequence
from functools import cache

import numpy as np

from vision_core.calibration.board.board import BOARDS, Board
from vision_core.geometry import Bytes, Floats
from vision_core.models.camera import PinholeCamera

SIZE_PX = (480, 360)
LENS = PinholeCamera(390.0, (244.5, 176.6), (-0.12, 0.03, 4e-4, -3e-4, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
SUBPIXELS = 3
WHITE, BLACK, GROUND = 215.0, 30.0, 95.0
POSES = (
    ((-0.52, -0.36, 1.0), (35, 0, 0)),
    ((0.52, -0.36, 1.05), (0, -35, 5)),
    ((-0.52, 0.36, 1.0), (-20, 30, 90)),
    ((0.52, 0.36, 1.1), (-35, 0, -8)),
    ((0.0, 0.0, 0.9), (0, 30, 10)),
    ((0.0, -0.42, 1.0), (10, 10, 90)),
    ((0.0, 0.42, 1.0), (-25, -15, 88)),
)
"""Middle of the board in the picture, as a share of its half sides from the middle, and distance in board heights; its
turns about the camera's x, y, z [deg]."""


def board_pictures(
    poses: Sequence[tuple[tuple[float, float, float], tuple[float, float, float]]] = POSES,
    *,
    lens: PinholeCamera = LENS,
    board: Board = BOARDS["A4"],
    noise: float = 2.0,
) -> list[Bytes]:
    """One picture per pose, shape (360, 480, 3)."""
    rng = np.random.default_rng(5)
    return [_picture(lens, board, place, turn, noise, rng) for place, turn in poses]


def _picture(
    lens: PinholeCamera,
    board: Board,
    place: tuple[float, float, float],
    turn_deg: tuple[float, float, float],
    noise: float,
    rng: np.random.Generator,
) -> Bytes:
    width, height = SIZE_PX
    rays = _rays(lens)
    from_board = _rotation(turn_deg)
    distance = place[2] * board.rows * lens.focal_px / height
    aside = np.array([place[0] * width, place[1] * height]) / 2.0 / lens.focal_px
    middle = np.array([*aside, 1.0]) * distance
    normal = from_board[:, 2]
    there = rays * ((normal @ middle) / (rays @ normal))[:, None] - middle
    on_board = there @ from_board[:, :2] + np.array([board.columns, board.rows]) / 2.0
    picture = _levels(board, on_board).reshape(height, width, -1).mean(axis=-1)
    picture += rng.normal(0.0, noise, picture.shape)
    return np.repeat(picture.clip(0, 255).round().astype(np.uint8)[..., None], 3, axis=-1)


@cache
def _rays(lens: PinholeCamera) -> Floats:
    """Directions of SUBPIXELS x SUBPIXELS rays of each pixel, row by row, shape (n, 3)."""
    width, height = SIZE_PX
    pixels = np.stack(np.meshgrid(np.arange(width, dtype=float), np.arange(height)), axis=-1).reshape(-1, 2)
    middles = (lens.ray_from_pixel(pixels) * (1.0, -1.0, -1.0)).reshape(height, width, 3)
    down, right, _ = np.gradient(middles)
    fine = (np.arange(SUBPIXELS) + 0.5) / SUBPIXELS - 0.5
    rays: Floats = np.stack([middles + dx * right + dy * down for dy in fine for dx in fine], axis=2).reshape(-1, 3)
    return rays


def _levels(board: Board, squares: Floats) -> Floats:
    """Grey of places of the board, in squares from its corner; round it is a rim of white paper."""
    modules = board.modules()
    at = np.floor(squares * 8.0).astype(int)
    rows, columns = modules.shape
    inside = ((at >= 0) & (at < (columns, rows))).all(axis=1)
    paper = ((squares >= -0.5) & (squares <= np.array([board.columns, board.rows]) + 0.5)).all(axis=1)
    levels = np.where(paper, WHITE, GROUND)
    levels[inside] = np.where(modules[at[inside, 1], at[inside, 0]], BLACK, WHITE)
    return levels


def _rotation(turn_deg: tuple[float, float, float]) -> Floats:
    a, b, c = np.radians(turn_deg)
    x = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    z = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]])
    turned: Floats = z @ y @ x
    return turned

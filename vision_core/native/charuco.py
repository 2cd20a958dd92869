"""ChArUco boards in OpenCV, in types of our own: the printed pattern, its corners in a picture, a lens from these."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

import vision_core.native.opencv  # noqa: F401  it switches OpenCV's threads off
from vision_core.geometry import Bytes, Floats, Mask

DICTIONARY = cv2.aruco.DICT_4X4_50
"""Markers of 4x4 modules and a rim: 6x6."""
SQUARE_MODULES, MARKER_MODULES = 8, 6
FIRST_FOCAL = 0.9
"""Focal length to begin with, as a share of the picture's longer side."""
STOP = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 60, 1e-9)
COEFFICIENTS = 5
"""k1, k2, p1, p2, k3."""


@dataclass(frozen=True, slots=True, eq=False)
class Views:
    """A lens that was fitted to corners of boards, and where every board was."""

    focal_px: float
    center_px: Floats
    """Shape (2,)."""
    distortion: Floats
    """k1, k2, p1, p2, k3; shape (5,)."""
    turns: tuple[Floats, ...]
    """Rotation vector of each board, camera from board; shape (3,) each."""
    places: tuple[Floats, ...]
    """Of each board's origin in camera space, in squares; shape (3,) each."""


class CharucoBoard:
    """A board of columns x rows squares whose markers have the numbers from first_marker on."""

    def __init__(self, columns: int, rows: int, first_marker: int):
        self._columns, self._rows = columns, rows
        markers = np.arange(first_marker, first_marker + columns * rows // 2)
        dictionary = cv2.aruco.getPredefinedDictionary(DICTIONARY)
        share = MARKER_MODULES / SQUARE_MODULES
        self._board = cv2.aruco.CharucoBoard((columns, rows), 1.0, share, dictionary, markers)
        self._detector = cv2.aruco.CharucoDetector(self._board)

    @property
    def corners(self) -> Floats:
        """The inner corners by their numbers, in squares from the board's corner; shape (n, 2)."""
        return np.asarray(self._board.getChessboardCorners(), dtype=np.float64)[:, :2]

    def modules(self) -> Mask:
        """Which modules are black, shape (rows * SQUARE_MODULES, columns * SQUARE_MODULES)."""
        size = self._columns * SQUARE_MODULES, self._rows * SQUARE_MODULES
        black: Mask = np.asarray(self._board.generateImage(size)) < 128
        return black

    def find(self, luma: Bytes) -> tuple[NDArray[np.intp], Floats]:
        """Corners of the board in a grey picture, to a part of a pixel: numbers, shape (n,), and pixels, (n, 2)."""
        pixels, numbers, _, _ = self._detector.detectBoard(luma)
        if numbers is None:
            return np.empty(0, dtype=np.intp), np.empty((0, 2))
        return np.asarray(numbers).ravel().astype(np.intp), np.asarray(pixels, dtype=np.float64).reshape(-1, 2)


def fit_views(
    points: Sequence[Floats], pixels: Sequence[Floats], size_px: tuple[int, int], *, frees_k3: bool
) -> Views | None:
    """The lens that sees flat boards best: square pixels, k1, k2, p1, p2 and, if it is freed, k3; None: no lens does.

    points, pixels: shape (n, 2) of each picture, n >= 4 and not on one line; size_px: width and height.
    """
    focal, middle = FIRST_FOCAL * max(size_px), (np.array(size_px) - 1.0) / 2.0
    matrix = np.array([[focal, 0.0, middle[0]], [0.0, focal, middle[1]], [0.0, 0.0, 1.0]])
    flags = cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_FIX_ASPECT_RATIO | (0 if frees_k3 else cv2.CALIB_FIX_K3)
    solid = [np.column_stack([one, np.zeros(len(one))]).astype(np.float32) for one in points]
    seen = [one.astype(np.float32) for one in pixels]
    try:
        _, matrix, distortion, turns, places = cv2.calibrateCamera(
            solid, seen, size_px, matrix, np.zeros(COEFFICIENTS), flags=flags, criteria=STOP
        )
    except cv2.error:
        return None
    found = Views(
        float(matrix[0, 0]),
        np.array([matrix[0, 2], matrix[1, 2]], dtype=np.float64),
        np.asarray(distortion, dtype=np.float64).ravel()[:COEFFICIENTS],
        tuple(np.asarray(turn, dtype=np.float64).ravel() for turn in turns),
        tuple(np.asarray(place, dtype=np.float64).ravel() for place in places),
    )
    values = [found.focal_px, *found.center_px, *found.distortion]
    return found if np.isfinite(values).all() and found.focal_px > 0.0 else None


def seen_points(views: Views, turn: Floats, place: Floats, points: Floats) -> tuple[Floats, Floats, Floats]:
    """Where a lens sees points of a board, shape (n, 2), and how that moves with the board's pose and with the lens.

    turn, place: as of ``Views``. Returns pixels, shape (n, 2), their derivatives by turn and place, shape (2 n, 6), and
    by focal length, center (2) and k1, k2, p1, p2, k3, shape (2 n, 8).
    """
    matrix = np.array([[views.focal_px, 0.0, views.center_px[0]], [0.0, views.focal_px, views.center_px[1]], [0, 0, 1]])
    solid = np.column_stack([points, np.zeros(len(points))])
    pixels, derivatives = cv2.projectPoints(solid, turn, place, matrix, views.distortion)
    slopes: Floats = np.asarray(derivatives, dtype=np.float64)
    focal = slopes[:, 6] + slopes[:, 7]
    lens = np.column_stack([focal, slopes[:, 8:10], slopes[:, 10 : 10 + COEFFICIENTS]])
    return np.asarray(pixels, dtype=np.float64).reshape(-1, 2), slopes[:, :6], lens


def pose_of(views: Views, points: Floats, pixels: Floats) -> tuple[Floats, Floats] | None:
    """Turn and place of a board that a known lens sees, as of ``Views``; None: no place explains it."""
    matrix = np.array([[views.focal_px, 0.0, views.center_px[0]], [0.0, views.focal_px, views.center_px[1]], [0, 0, 1]])
    solid = np.column_stack([points, np.zeros(len(points))])
    try:
        is_found, turn, place = cv2.solvePnP(solid, pixels, matrix, views.distortion)
    except cv2.error:
        return None
    return (
        (np.asarray(turn, dtype=np.float64).ravel(), np.asarray(place, dtype=np.float64).ravel()) if is_found else None
    )


def turn_matrix(turn: Floats) -> Floats:
    """The rotation by a vector, shape (3,) -> (3, 3)."""
    return np.asarray(cv2.Rodrigues(turn)[0], dtype=np.float64)

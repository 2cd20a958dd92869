"""From pictures of a board to a lens and a verdict."""

from collections.abc import Sequence

from vision_core.calibration.board.corners import BoardView, find_board
from vision_core.calibration.board.judge import MIN_PICTURES, judged
from vision_core.calibration.board.result import LensCalibration
from vision_core.calibration.board.solve import fit_lens
from vision_core.calibration.judge import size_reasons
from vision_core.calibration.result import Progress, no_progress
from vision_core.geometry import Bytes


def calibrate_lens(
    pictures: Sequence[Bytes], names: Sequence[str], *, progress: Progress = no_progress
) -> LensCalibration:
    """The lens of the camera that took pictures of a board of ``board.BOARDS``, held at several places and tilts.

    pictures: shape (height, width, 3) each, of one size, one at least; names: what messages call them. What is refused
    says so in its reasons. Raises what progress raises.
    """
    size = pictures[0].shape[1], pictures[0].shape[0]
    if reasons := size_reasons(pictures):
        return judged(names, ["another size"] * len(names), size, None, reasons)
    found: list[BoardView | str] = []
    for number, (name, pixels) in enumerate(zip(names, pictures, strict=True)):
        progress(f"searching the board in {name}", 0.7 * number / len(pictures))
        found.append(find_board(pixels))
    progress("fitting the lens", 0.7)
    seen = [one for one in found if isinstance(one, BoardView)]
    fitted = fit_lens(seen, size) if len(seen) >= MIN_PICTURES else None
    progress("checking the result", 0.85)
    result = judged(names, found, size, fitted, ())
    progress("done", 1.0)
    return result

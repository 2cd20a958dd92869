"""The two segmentations as objects that own their buffers, for benchmarks and tests. The service calls the kernels.

As in the service, the buffers are boxed: taken apart once, and without counted references.
"""

import numpy as np

from vision_core.blobs.bits import Bits
from vision_core.blobs.row_scan import Boxes, segment_buffers, segment_picture
from vision_core.blobs.run_lengths import run_buffers, segment_runs
from vision_core.geometry import Bytes
from vision_core.native.kernels import Boxed, box, kernel, read_only
from vision_core.settings.schema import BlobSettings
from vision_core.types.colors import ColorTable
from vision_core.types.prefilter import ColorPrefilter
from vision_core.types.tables import BLOB, Table


class ReferenceSegmenter:
    """Finds the blobs of pictures of one size by the reference segmentation, which reads every pixel.

    Threads must not share a segmenter: each call writes into the same buffers.
    """

    def __init__(self, width_px: int, height_px: int, settings: BlobSettings, masked: Bits | None = None) -> None:
        self._shape = (height_px, width_px, 3)
        self._min_area_px = settings.min_area_px
        self._buffers = box(run_buffers(settings, masked))
        self.blobs: Table = np.zeros(settings.max_blobs, dtype=BLOB)
        """Filled by ``segment``, in scan order."""

    def segment(self, pixels: Bytes, table: ColorTable) -> tuple[int, bool]:
        """Fill ``blobs``. Returns the number of blobs, and whether there was room for all.

        pixels: shape (height, width, 3), contiguous, blue green red.
        """
        assert pixels.shape == self._shape, f"{pixels.shape} is not {self._shape}"
        return _segment_runs(read_only(pixels), read_only(table.classes), self._min_area_px, self._buffers, self.blobs)


class RowScanSegmenter:
    """Finds the blobs of pictures of one size by the row scan: all of at least min_height_px, most others.

    Threads must not share a segmenter. The first rows of ``blobs`` are the result of the last call of ``segment``.
    """

    def __init__(
        self, width_px: int, height_px: int, settings: BlobSettings, min_height_px: int, masked: Bits | None = None
    ) -> None:
        self._shape = (height_px, width_px, 3)
        self._buffers = box(segment_buffers(width_px, height_px, settings, min_height_px, masked))
        self.blobs: Table = np.zeros(settings.max_blobs, dtype=BLOB)
        self._no_windows = np.zeros((0, 4), dtype=np.int32)

    def segment(
        self, pixels: Bytes, table: ColorTable, prefilter: ColorPrefilter, windows: Boxes | None = None
    ) -> tuple[int, bool]:
        """Fill ``blobs``, in another order than the reference. Returns their number and whether there was room for all.

        pixels: shape (height, width, 3), blue green red. prefilter: made from the same table. windows: left, top,
        right, bottom, inclusive, shape (n, 4), segmented in addition to the rolling scan band; None: the whole picture.
        """
        assert pixels.shape == self._shape, f"{pixels.shape} is not {self._shape}"
        whole = windows is None
        boxes = self._no_windows if windows is None else np.ascontiguousarray(windows, dtype=np.int32)
        return _segment_picture(
            read_only(pixels), read_only(table.classes), prefilter, boxes, len(boxes), whole, self._buffers, self.blobs
        )


@kernel
def _segment_runs(pixels: Bytes, classes: Bytes, min_area: int, boxed: Boxed, blobs: Table) -> tuple[int, bool]:
    return segment_runs(pixels, classes, min_area, boxed.value, blobs)


@kernel
def _segment_picture(
    pixels: Bytes, classes: Bytes, prefilter: ColorPrefilter, windows: Boxes, window_count: int, whole: bool,
    boxed: Boxed, blobs: Table,
) -> tuple[int, bool]:  # fmt: skip
    return segment_picture(pixels, classes, prefilter, windows, window_count, whole, boxed.value, blobs)

"""The methods that are measured do the same work: equal blobs in C and in Python, and the windows of the service."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st
from msgspec.structs import replace

from bench import segmentation
from bench.baselines.build import load_library
from bench.segmentation import SIZES, c_reference_of
from bench.segmenters import ReferenceSegmenter
from tests.blobs.test_run_lengths import blue_table, picture
from vision_core.venues.loader import load_settings

SETTINGS = load_settings(options=SIZES["640x480"])


@given(
    st.integers(0, 10_000), st.integers(1, 600), st.integers(1, 12), st.floats(0.0, 1.0), st.integers(1, 4)
)  # fmt: skip
@examples(max_examples=60, deadline=None)
def test_the_reference_in_c_finds_equal_blobs(seed: int, width: int, height: int, density: float, repeat: int) -> None:
    rng = np.random.default_rng(seed)
    labels = np.where(rng.random((height, width)) < density, rng.integers(1, 4, (height, width)), 0)
    pixels, table = picture(labels.repeat(repeat, axis=1)[:, :width]), blue_table()
    settings = replace(SETTINGS, blobs=replace(SETTINGS.blobs, min_area_px=1, max_runs=8000, max_blobs=8000))
    in_c, message = c_reference_of(settings, table, [pixels])
    if in_c is None:
        pytest.skip(message)
    reference = ReferenceSegmenter(width, height, settings.blobs)
    count, complete = reference.segment(pixels, table)
    assert complete
    segment, blobs = in_c
    assert segment(0) == count
    assert (blobs[:count] == reference.blobs[:count]).all()


def test_the_reference_in_c_says_when_there_is_no_room() -> None:
    library, message = load_library("segmentation")
    if library is None:
        pytest.skip(message)
    few = replace(SETTINGS, blobs=replace(SETTINGS.blobs, min_area_px=1, max_runs=2))
    in_c, _ = c_reference_of(few, blue_table(), [picture(np.array([[1, 2, 3]]))])
    assert in_c is not None
    with pytest.raises(AssertionError, match="2 runs"):
        in_c[0](0)


@pytest.mark.slow
def test_windows_are_those_of_a_perception_that_follows_the_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(segmentation, "FRAMES", 3)
    scene = segmentation.scene_of(SETTINGS)
    assert len(scene.frames) == 3
    for windows, objects in zip(scene.windows, scene.objects, strict=True):
        centers = (objects[:, :2] + objects[:, 2:]) / 2.0
        for center in centers:
            assert ((windows[:, :2] < center) & (center < windows[:, 2:])).all(axis=1).any()
    methods = segmentation.Methods(scene)
    assert segmentation.recall_of(scene, methods, segmentation.WINDOWS) == 1.0

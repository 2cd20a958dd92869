"""An address names a source, or the error says which addresses do."""

import pytest

from vision_core.capture.source import ACCEPTED, open_source
from vision_core.clock import ManualClock
from vision_core.errors import SourceError
from vision_core.models.camera_setup import CameraSetup
from vision_core.venues.loader import load_settings


@pytest.mark.parametrize("uri", ["", "simulation", "synthetic:1", "file:", "camera:", "rtsp://10.0.0.1", "0"])
def test_an_unknown_address_names_the_known_ones(uri: str) -> None:
    settings = load_settings(options={"source.uri": uri})
    with pytest.raises(SourceError) as caught:
        open_source(settings, CameraSetup.from_settings(settings), ManualClock())
    assert caught.value.found == repr(uri)
    assert caught.value.accepted == ACCEPTED


def test_the_synthetic_camera_says_what_it_is() -> None:
    source = open_source(
        load_settings(options={"synthetic.seed": 12}),
        CameraSetup.from_settings(load_settings(options={"synthetic.seed": 12})),
        ManualClock(),
    )
    assert (source.description, source.repeats) == ("synthetic, seed 12", False)
    assert source.rate_hz == 30.0
    source.close()

"""Colors of a new venue: sampled, mapped, and found without a click; the file keeps what was found with them."""

import msgspec
import pytest

from tests.setup.demo import demo_pictures
from tests.setup.test_venue_file import complete
from vision_core.errors import SettingsError
from vision_core.setup.choices import with_sample
from vision_core.setup.colors import class_map, find_all_colors, sample_at
from vision_core.setup.draft import Draft
from vision_core.setup.findings import with_colors
from vision_core.setup.floor_colors import floor_colors
from vision_core.setup.venue_file import settings_of

pytestmark = [pytest.mark.slow, pytest.mark.timeout(300)]


@pytest.fixture(scope="module")
def bare() -> Draft:
    return msgspec.structs.replace(complete(), samples={})


def test_a_sample_makes_a_class_where_its_color_is(bare: Draft) -> None:
    picture = demo_pictures()[0]
    floor = floor_colors(picture.pixels)
    draft = msgspec.structs.replace(bare, samples={"none": floor})
    for name, places in picture.papers().items():
        draft = with_sample(draft, name, sample_at(draft, picture.pixels, places[0], 1).color)
    found = class_map(draft, picture.pixels)
    assert found.pixels.startswith(b"\x89PNG")
    assert set(found.shares) == set(found.colors) == set(picture.papers())
    assert all(0.0 < share < 0.01 for share in found.shares.values())
    with pytest.raises(SettingsError, match="a sample at 640, 0; found: a place outside of the picture"):
        sample_at(draft, picture.pixels, (640, 0), 1)


def test_colors_are_found_and_the_file_keeps_their_light(bare: Draft) -> None:
    told: list[float] = []
    pictures = [picture.pixels for picture in demo_pictures()]
    found = find_all_colors(bare, pictures, lambda _what, share: told.append(share))
    assert found.is_accepted, found.reasons
    assert found.with_id >= 5
    assert {paint.name for paint in found.paints} == {"orange", "blue", "yellow", "pink", "green"}
    assert told == sorted(told)
    draft = with_colors(bare, found)
    settings = settings_of(draft, complete=True)
    assert settings.colors.sampling == found.sampling
    assert settings.colors.light == found.light
    assert settings.colors.samples == found.samples
    assert "none" in found.samples
    doubtful = msgspec.structs.replace(found, is_accepted=False, reasons=())
    with pytest.raises(SettingsError, match="no robot that is read clearly"):
        with_colors(bare, doubtful)
    assert with_colors(bare, doubtful, takes_doubtful=True) == draft


def test_what_is_picked_is_floor_no_longer(bare: Draft) -> None:
    draft = msgspec.structs.replace(bare, samples={"none": ("#e06a2c", "#d8602a", "#204020")})
    assert with_sample(draft, "orange", "#e06a2c").samples == {"none": ("#204020",), "orange": ("#e06a2c",)}
    assert with_sample(draft, "none", "#e06a2d").samples["none"][-1] == "#e06a2d"

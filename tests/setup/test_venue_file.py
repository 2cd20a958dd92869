"""A draft's file: what is tried is what is saved, and the file says why each value is what it is."""

import tomllib
from pathlib import Path

import msgspec
import pytest

from vision_core.errors import SettingsError
from vision_core.settings.schema import HomographySettings, NamedPoint
from vision_core.setup.choices import needed_colors, with_pattern, with_preset, with_sample, without_sample
from vision_core.setup.draft import Draft, DraftCamera, DraftPicture
from vision_core.setup.venue_file import save_venue, settings_of, venue_text
from vision_core.venues.loader import load_settings, own_venues_folder

COLORS = {"orange": "#e06a2c", "blue": "#1f4fb0", "yellow": "#d8c83a", "green": "#3fbf5a", "pink": "#d05a9a"}


def complete(name: str = "lab") -> Draft:
    """Everything that a venue needs; a lens of the demo."""
    shipped = load_settings()
    picture = DraftPicture(file="1.png", name="field.png", width_px=640, height_px=480)
    camera = DraftCamera("pinhole", (640, 480), "Calibrated.", (46.7, 98.0, 37.4), pinhole=shipped.camera.pinhole)
    draft = with_pattern(with_preset(Draft(name=name, pictures=(picture,)), "ssl-2002"), "ssl-standard")
    draft = msgspec.structs.replace(draft, camera=camera)
    for color, sample in COLORS.items():
        draft = with_sample(draft, color, sample)
    return draft


def test_a_file_gives_the_settings_that_were_tried() -> None:
    draft = complete()
    settings = settings_of(draft, complete=True)
    assert settings.camera.pinhole == load_settings().camera.pinhole
    assert settings.field.name == "ssl-2002"
    assert settings.colors.classes == {}
    assert settings.colors.samples == {name: (sample,) for name, sample in COLORS.items()}
    assert settings.colors.light.reference_bgr == (46.7, 98.0, 37.4)
    assert settings.robots.pattern == "ssl-standard"
    text = venue_text(draft)
    assert text.startswith("# lab. Set up on ")
    assert "from one picture of 640x480: field.png." in text
    assert "# Calibrated.\n[camera]" in text
    assert "[field]" not in text, "the preset says it"


def test_own_measures_and_named_points_are_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    draft = complete()
    assert draft.field is not None
    corners = ((-1.5, 1.0), (1.5, 1.0), (1.5, -1.0), (-1.5, -1.0))
    pixels = ((20.0, 40.0), (620.0, 40.0), (620.0, 440.0), (20.0, 440.0))
    points = tuple(
        NamedPoint(name=f'corner "{n}"', pixel_px=pixel, field_m=place)
        for n, (pixel, place) in enumerate(zip(pixels, corners, strict=True))
    )
    homography = HomographySettings(points=points, position_m=(0.0, 0.0, 3.0))
    camera = DraftCamera("homography", (640, 480), "Four corners.", (1.0, 2.0, 3.0), homography=homography)
    field = msgspec.structs.replace(draft.field, name="lab", length_m=3.0, width_m=2.0)
    draft = msgspec.structs.replace(draft, field=field, camera=camera, about='A "lab"\n[camera]', source="camera:2")
    settings = settings_of(draft, complete=True)
    assert settings.field == field
    assert settings.camera.homography == homography
    assert settings.source.uri == "camera:2"
    assert 'A "lab" [camera]. Set up' in venue_text(draft), "a comment stays a comment"
    monkeypatch.setenv("PSLV_DATA_DIR", str(tmp_path))
    assert load_settings(str(save_venue(draft, []))) == settings


def test_what_is_missing_is_named_step_by_step() -> None:
    whole = complete()
    for lacking, words in (
        ({"pictures": ()}, "the pictures; found: not chosen yet"),
        ({"field": None}, "the field; found"),
        ({"camera": None}, "the camera; found"),
        ({"pattern": ""}, "the markers; found"),
        ({"samples": {"orange": ("#e06a2c",)}}, "no sample of blue, pink, green, yellow"),
    ):
        with pytest.raises(SettingsError, match=words):
            settings_of(msgspec.structs.replace(whole, **lacking), complete=True)
    partly = msgspec.structs.replace(whole, samples={})
    assert settings_of(partly).colors.samples == {}, "colors are measured with the settings so far"


def test_a_venue_is_saved_and_found_by_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PSLV_DATA_DIR", str(tmp_path))
    picture = tmp_path / "field.jpg"
    picture.write_bytes(b"a picture")
    draft = msgspec.structs.replace(complete(), source="pictures")
    path = save_venue(draft, [picture])
    assert path == own_venues_folder() / "lab.toml"
    loaded = load_settings("lab")
    assert loaded.source.uri == f"file:{tmp_path}/venues/lab"
    assert [file.read_bytes() for file in (tmp_path / "venues" / "lab").iterdir()] == [b"a picture"]
    with pytest.raises(SettingsError, match="is there already"):
        save_venue(draft, [picture])
    assert save_venue(msgspec.structs.replace(draft, numbers=3), [picture], replaces=True) == path
    assert load_settings("lab").match.numbers == 3
    with pytest.raises(SettingsError, match="comes with PSLV"):
        save_venue(complete("sdp-2011"), [])
    with pytest.raises(SettingsError, match="accepted: .*lab.*vsss-video"):
        load_settings("nope")


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "venues").write_text("a file")
    monkeypatch.setenv("PSLV_DATA_DIR", str(tmp_path))
    with pytest.raises(SettingsError, match="accepted: a folder that can be written"):
        save_venue(complete(), [])


def test_samples_belong_to_colors_that_are_worn() -> None:
    draft = complete()
    assert needed_colors(draft) == ["orange", "blue", "pink", "green", "yellow"]
    with pytest.raises(SettingsError, match="color class purple; found: nothing wears it"):
        with_sample(draft, "purple", "#800080")
    with pytest.raises(SettingsError, match="a sample of orange; accepted: each color in one class"):
        with_sample(draft, "pink", COLORS["orange"])
    assert with_sample(draft, "orange", COLORS["orange"]) == draft, "no color twice"
    assert "orange" not in without_sample(draft, "orange", COLORS["orange"]).samples
    assert tomllib.loads(venue_text(with_sample(draft, "none", "#203020")))["colors"]["samples"]["none"] == ["#203020"]

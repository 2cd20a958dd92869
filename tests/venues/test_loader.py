"""One loader: every shipped file loads, every key is declared once, every mistake is named."""

import os
import re
import shutil
import tomllib
from pathlib import Path
from typing import Any

import msgspec
import pytest

from vision_core.errors import SettingsError
from vision_core.patterns.loader import load_pattern
from vision_core.settings.layers import Layer, LayerKind
from vision_core.settings.schema import MirrorConstants, Settings
from vision_core.venues.loader import (
    RENAMED,
    config_folder,
    find_file,
    layers_of,
    load_settings,
    settings_from_layers,
    with_overlay,
)

DEFAULT = tomllib.loads((config_folder() / "default.toml").read_text())


@pytest.mark.parametrize("path", sorted((config_folder() / "venues").glob("*.toml")), ids=lambda path: path.stem)
def test_every_shipped_venue_loads(path: Path) -> None:
    load_settings(venue=path.stem)


@pytest.mark.parametrize("path", sorted((config_folder() / "fields").glob("*.toml")), ids=lambda path: path.stem)
def test_every_shipped_field_loads(path: Path) -> None:
    settings = load_settings(options={"field_preset": path.stem})
    assert settings.field.name == path.stem


def test_the_minimal_file_loads() -> None:
    assert load_settings(venue=str(config_folder() / "minimal.toml")).source.uri == "camera:0"


def keys_of(table: dict[str, Any], path: str = "") -> set[str]:
    keys = set()
    for key, value in table.items():
        here = f"{path}{key}"
        keys |= keys_of(value, f"{here}.") if isinstance(value, dict) and here != "colors.classes" else {here}
    return keys


def test_the_default_file_teaches_every_key() -> None:
    """Each key that a struct declares stands in default.toml or in the field preset, and none is optional there."""
    loaded: dict[str, Any] = msgspec.to_builtins(load_settings())
    loaded["camera"].pop("homography")  # the alternative to the pinhole stands there as a comment
    loaded["camera"].pop("lens")
    for team in ("blue", "yellow"):  # a team's own robots: a comment too
        loaded["robots"].pop(team)
        loaded["mirror"].pop(team)
    for name, task in loaded["tasks"].items():  # of a task only its times stand there; the rest may be left out
        loaded["tasks"][name] = {key: value for key, value in task.items() if key in DEFAULT["tasks"][name]}
        assert {"priority", "period_ms", "budget_ms"} <= loaded["tasks"][name].keys()
    preset = tomllib.loads((config_folder() / "fields" / "ssl-2002.toml").read_text())
    pattern = tomllib.loads((config_folder() / "patterns" / "ssl-standard.toml").read_text())
    assert keys_of(loaded) == keys_of(DEFAULT) | keys_of(preset) | keys_of({"robots": pattern["robot"]})


def test_every_key_of_the_default_file_is_explained() -> None:
    """A section or a line says what the key does; repeated kinds of lines need it once."""
    text = (config_folder() / "default.toml").read_text()
    for section in re.split(r"^\[", text, flags=re.MULTILINE)[1:]:
        assert "#" in section, section


def test_settings_are_frozen() -> None:
    settings = load_settings()
    with pytest.raises(AttributeError):
        settings.camera.rate_hz = 60.0  # type: ignore[misc]


def test_later_layers_win(tmp_path: Path) -> None:
    venue, config = tmp_path / "venue.toml", tmp_path / "config.toml"
    venue.write_text("[camera]\nrate_hz = 50.0\nwidth_px = 800\n[robots]\nradius_m = 0.04\n")
    config.write_text("[camera]\nwidth_px = 1000\n")
    settings = load_settings(str(venue), config, {"server.port": 9000, "server.host": None})
    assert (settings.camera.rate_hz, settings.camera.width_px, settings.robots.radius_m) == (50.0, 1000, 0.04)
    assert (settings.server.port, settings.server.host) == (9000, DEFAULT["server"]["host"])


def test_a_venue_chooses_its_field(tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text('field_preset = "ssl-division-b"\n[field]\nmargin_m = 0.2\n')
    field = load_settings(str(venue)).field
    assert (field.length_m, field.margin_m, field.walls) == (9.0, 0.2, False)


def test_what_was_changed_on_the_page_stands_between_files_and_command_line(tmp_path: Path) -> None:
    config = tmp_path / "config.toml"
    config.write_text('[tracks]\ngate_m = 0.3\n[match]\nblue_defends = "right"\n')
    layers = layers_of(config=config, options={"server.port": 9000})
    config.unlink()  # from here on no file of the user's is read
    changed = with_overlay(
        layers, {"tracks.gate_m": 0.4, "server.port": 7000, "mirror.blue": {"a": 4, "b": 0.0126, "c": 9e4}}
    )
    settings = settings_from_layers(changed)
    assert (settings.tracks.gate_m, settings.server.port, settings.match.blue_defends) == (0.4, 9000, "right")
    assert settings.mirror.blue == MirrorConstants(a=4.0, b=0.0126, c=9e4)
    assert [layer.kind for layer in changed[-3:]] == [LayerKind.CONFIG, LayerKind.PAGE, LayerKind.OPTIONS]
    again = settings_from_layers(with_overlay(changed, {"tracks.gate_m": 0.5}))
    assert (again.tracks.gate_m, again.mirror.blue) == (0.5, None), "an overlay replaces the one before"


def test_the_page_may_choose_another_field(tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text("[field]\nmargin_m = 0.2\n")
    layers = layers_of(str(venue))
    venue.unlink()
    chosen = with_overlay(layers, {"field_preset": "ssl-division-b"})
    field = settings_from_layers(chosen).field
    assert (field.length_m, field.margin_m) == (9.0, 0.2)
    assert settings_from_layers(with_overlay(chosen, {})).field.length_m == 2.8, "the choice was taken back"


@pytest.mark.parametrize(
    ("overlay", "said"),
    [
        (
            {"tracks.gate": 1.0},
            r"^changes made on the page: tracks.gate; found: no setting of this name \(did you mean gate_m",
        ),
        ({"tracks.gate_m": "x"}, "^changes made on the page: tracks.gate_m; found: 'x'; accepted: a number"),
        (
            {"tracks": 1, "tracks.gate_m": 1.0},
            "^changes made on the page: tracks.gate_m; found: a value for tracks as well",
        ),
        ({".".join("x" * 40): 1}, "^changes made on the page; found: a key of more than 16 parts"),
        (
            {"match.play_mode": "halftime"},
            "match.play_mode; found: 'halftime'; accepted: before_kick_off, corner",
        ),
        (
            {"mirror.yellow": {"a": 4.0, "b": -1.0, "c": 9e4}},
            "page: mirror.yellow; found: A 4, B -1, .*; accepted: B >= 0",
        ),
        ({"mirror.yellow": {"a": 4.0}}, "page: mirror.yellow.b; found: nothing; accepted: a value"),
        ({"admission.rules": [{"network": "laptop"}]}, "page: admission.rules; found: 'laptop' does not appear to be"),
        (
            {"admission.rules": [{"network": "::1", "team": "red"}]},
            "page: admission.rules.0.team; found: 'red'; accepted: ",
        ),
        ({"admission.refused": ["10.0.0.1/8"]}, "page: admission.refused; found: 10.0.0.1/8 has host bits set"),
        ({"field_preset": "moon"}, "field 'moon'; found: no such file"),
    ],
)
def test_a_change_on_the_page_that_cannot_be_names_the_page(overlay: dict[str, Any], said: str) -> None:
    layers = layers_of()
    with pytest.raises(SettingsError, match=said):
        settings_from_layers(with_overlay(layers, overlay))


def test_a_mirror_that_does_not_reach_over_the_field_is_refused() -> None:
    short = {"a": 40.187, "b": 0.125935, "c": 90000.0}
    with pytest.raises(SettingsError, match="page: mirror.blue; found: only .* px between one metre and the diagonal"):
        settings_from_layers(with_overlay(layers_of(), {"field_preset": "ssl-division-b", "mirror.blue": short}))


def test_layers_survive_the_database() -> None:
    layers = with_overlay(layers_of("demo-vsss"), {"match.blue_name": "Blues"})
    kept = msgspec.msgpack.decode(msgspec.msgpack.encode(layers), type=tuple[Layer, ...])
    assert settings_from_layers(kept) == settings_from_layers(layers)


def test_a_palette_is_replaced_as_a_whole(tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text("[colors.classes]\norange = [{ hue_deg = [0, 40] }]\n")
    assert list(load_settings(str(venue)).colors.classes) == ["orange"]


WRONG = [
    ("[camera]\nwidth_px = 3", "camera.width_px; found: 3; accepted: a whole number >= 64"),
    ("[camera]\nwdth_px = 640", r"camera.wdth_px; found: no setting of this name \(did you mean width_px\?\)"),
    ("[camera]\nrate_hz = nan", "camera.rate_hz"),
    ("[mirrror]\na = 1", r"mirrror; found: no setting of this name \(did you mean mirror\?\)"),
    ("[server]\nport = 70000", "server.port; found: 70000; accepted: a whole number <= 65535"),
    ("[server]\nport = 'x'", "server.port; found: 'x'; accepted: a whole number"),
    ("[ball]\ncolor = 'red'", "ball.color; found: 'red'; accepted: a color class: orange, yellow"),
    ("[mirror]\nb = -1.0", "mirror; found: A 4.0187, B -1, C 90000; accepted: B >= 0"),
    ("[mirror]\na = nan", "mirror.a; found: nan; accepted: a number"),
    ("[camera]\nmodel = 'homography'", "camera.homography; found: nothing; accepted: four named points"),
    ("[camera.pinhole]\nposition_m = [0.0, 0.0, 0.1]", "camera.pinhole.position_m; found: 0.1 m high"),
    ("[colors.classes]\norange = [{ hue = [0, 1] }]", "orange.0.hue; found: no setting of this name .*hue_deg"),
    ("[colors.classes]\norange = [{ value = [0.9, 0.1] }]", r"orange.value; found: \[0.9, 0.1\]; accepted: the lower"),
    ("[colors.classes]\norange = [{ luma = [0, 9] }]", r"orange; found: luma; accepted: .*\(colors.space is hsv\)"),
    ("[match]\nblue_ids = [1, 1, 2, 3, 4, 5]", "match.blue_ids; .* each once"),
    ("[match]\nblue_ids = [1, 2, 3]", r"line 2: match.blue_ids; found: 3 ids, \[1, 2, 3\]; accepted: at least"),
    (
        '[colors.samples]\nred = ["#FF0000"]\npale = ["#ff0000"]',
        "line 3: colors.samples.pale; found: #ff0000, a sample of",
    ),
    (
        '[admission]\nsubnets = ["10.0.0.0/8", "192.168.1.300/24"]',
        "line 2: admission.subnets; found: '192.168.1.300/24'",
    ),
    (
        "[colors.classes]",
        "ball.color; found: 'orange'; accepted: a color class: there is none yet; to make it: pslv colors",
    ),
    ("[match]\nnumbers = 17", "match.numbers; found: 17; accepted: a whole number <= 16"),
    (
        "field_preset = 'moon'",
        "field 'moon'; found: no such file; accepted: mirosot-middle, ssl-2002, ssl-division-a, ssl-division-b",
    ),
    ("camera = 3", "camera; found: 3; accepted: a table"),
    ("[camera]\nmodel = 'homografy'", "camera.model; found: 'homografy'; accepted: homography, pinhole"),
    ("[protocol.letters]\nfirst_blue = '~'", "protocol.letters.first_blue"),
    ("[protocol.letters]\nwall = 'x'", "protocol.letters.wall; found: 'x', which means blue too"),
    ("[protocol.letters]\nfirst_blue = 'R'", "protocol.letters.first_blue; found: 'a', which means first_yellow too"),
    ("[protocol.letters]\nwal = 'W'", "protocol.letters.wal; found: no letter of this name; accepted: nothing, wall"),
    ("[protocol.letters]\nwall = 'wall'", "protocol.letters.wall; found: 'wall'"),
    ("[server]\nhost = ''", "server.host; found: ''; accepted: a text of length >= 1"),
    ("[tracks]\nrobot_noise_m = 1e308", "tracks.robot_noise_m; found: 1e[+]308"),
    ("[synthetic]\nseed = -1", "synthetic.seed; found: -1; accepted: a whole number >= 0"),
]


@pytest.mark.parametrize(("text", "message"), WRONG, ids=[text.replace("\n", " ") for text, _ in WRONG])
def test_a_mistake_names_file_key_found_and_accepted(tmp_path: Path, text: str, message: str) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text(text)
    with pytest.raises(SettingsError, match=message) as caught:
        load_settings(str(venue))
    if "field_preset" not in text and text != "[colors.classes]":
        assert str(venue) in str(caught.value)


@pytest.mark.parametrize("content", [b"[camera", b"\xff\xfe", b"a = 1\na = 2", b"a = " + b"[" * 5000])
def test_a_file_that_is_no_toml_is_named(tmp_path: Path, content: bytes) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_bytes(content)
    with pytest.raises(SettingsError, match=re.escape(str(venue))):
        load_settings(str(venue))


def test_a_byte_order_mark_is_no_part_of_the_text(tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_bytes(b"\xef\xbb\xbf[server]\nport = 9000\n")
    assert load_settings(str(venue)).server.port == 9000


def test_what_is_no_settings_file_is_refused_at_once(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.toml")
    (tmp_path / "zero.toml").symlink_to("/dev/zero")
    (tmp_path / "large.toml").write_text("#" * 300_000)
    (tmp_path / "dotted.toml").write_text("a" + ".a" * 1500 + " = 1\n")
    (tmp_path / "quoted.toml").write_text('a = 1\n"a"' + ' . "a"' * 40 + " = 1\n")
    (tmp_path / "nested.toml").write_text("a = " + "[" * 40 + "]" * 40)
    for name, found in (
        ("pipe.toml", "a FIFO"),
        ("zero.toml", "a device"),
        ("large.toml", "300000 bytes"),
        ("dotted.toml", "a key of more than 16 parts"),
        ("quoted.toml", "a key of more than 16 parts"),
        ("nested.toml", "tables in more than 16 others"),
    ):
        with pytest.raises(SettingsError, match=f"{name}; found: {found}"):
            load_settings(str(tmp_path / name))


def test_a_former_key_goes_on_to_work_and_says_so_once(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text(
        "[robots]\nbeyond_m = 0.2\n[colors.light]\nbeyond_m = 0.3\n[blobs]\nstrip = 0.2\nmost_flooded = 0.4\n"
        "[synthetic]\nfeet = 3\n"
    )
    settings = load_settings(str(venue))
    assert settings.robots.margin_m == 0.2
    assert settings.colors.light.margin_m == 0.3
    assert (settings.blobs.scan_band, settings.blobs.max_flood_fraction) == (0.2, 0.4)
    assert settings.synthetic.walking_people == 3
    assert caplog.messages == [
        f"robots.beyond_m is now called robots.margin_m ({venue}, line 2)",
        f"colors.light.beyond_m is now called colors.light.margin_m ({venue}, line 4)",
        f"blobs.strip is now called blobs.scan_band ({venue}, line 6)",
        f"blobs.most_flooded is now called blobs.max_flood_fraction ({venue}, line 7)",
        f"synthetic.feet is now called synthetic.walking_people ({venue}, line 9)",
    ]
    assert set(RENAMED.values()) <= keys_of(msgspec.to_builtins(settings))


def test_a_former_key_beside_its_present_one_is_refused(tmp_path: Path) -> None:
    venue = tmp_path / "venue.toml"
    venue.write_text("[robots]\nmargin_m = 0.1\nbeyond_m = 0.2\n")
    with pytest.raises(SettingsError, match=r"line 3: robots.beyond_m; found: robots.margin_m as well"):
        load_settings(str(venue))


def test_names_in_a_file_are_relative_to_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, elsewhere = tmp_path / "venue", tmp_path / "elsewhere"
    folder.mkdir()
    elsewhere.mkdir()
    monkeypatch.chdir(elsewhere)
    shutil.copy(config_folder() / "patterns" / "ssl-standard.toml", folder / "mine.toml")
    shutil.copy(config_folder() / "fields" / "ssl-2002.toml", folder / "field.toml")
    (folder / "venue.toml").write_text(
        'field_preset = "field.toml"\n[source]\nuri = "file:pictures"\n[robots]\npattern = "mine.toml"\n'
        '[robots.blue]\npattern = "ssl-standard"\n'
    )
    settings = load_settings("../venue/venue.toml")
    assert Path(settings.robots.patterns[0]).samefile(folder / "mine.toml")
    assert load_pattern(settings.robots.patterns[0]).name == load_pattern("ssl-standard").name
    assert settings.robots.blue is not None
    assert settings.robots.blue.pattern == "ssl-standard"
    assert Path(settings.source.uri.removeprefix("file:")) == elsewhere / "../venue/pictures"
    with pytest.raises(SettingsError, match="elsewhere/field.toml; found: No such file"):
        load_settings(options={"field_preset": str(elsewhere / "field.toml")})


def test_samples_replace_the_ranges_of_files_below(tmp_path: Path) -> None:
    venue, config = tmp_path / "venue.toml", tmp_path / "config.toml"
    venue.write_text('[colors.samples]\norange = ["#ff8000"]\n')
    settings = load_settings(str(venue))
    assert list(settings.colors.classes) == ["yellow", "blue", "pink", "green"]
    assert list(settings.colors.samples) == ["orange"]
    config.write_text("[colors.classes]\norange = [{ hue_deg = [0, 40] }]\n")
    settings = load_settings(str(venue), config)
    assert list(settings.colors.classes) == ["orange"]
    assert settings.colors.samples == {}


@pytest.mark.parametrize(
    ("kind", "text", "kept"),
    [
        (LayerKind.VENUE, "[synthetic]\nseed = 2\n", False),
        (LayerKind.CONFIG, "[synthetic]\nseed = 2\n", True),
        (LayerKind.CONFIG, '[colors.samples]\norange = ["#e06a2c"]\n', False),
        (LayerKind.CONFIG, '[source]\nuri = "camera:0"\n', False),
        (LayerKind.CONFIG, '[source]\nuri = "synthetic"\n', True),
    ],
)
def test_the_reference_of_the_light_belongs_to_the_colors(
    tmp_path: Path, kind: LayerKind, text: str, kept: bool
) -> None:
    own = tmp_path / "own.toml"
    own.write_text(text)
    name = "venue" if kind is LayerKind.VENUE else "config"

    def reference() -> tuple[float, float, float] | None:
        settings = load_settings(**{name: str(own) if name == "venue" else own})  # type: ignore[arg-type]
        return settings.colors.light.reference_bgr

    assert (reference() is not None) is kept
    own.write_text(f"{text}[colors.light]\nreference_bgr = [1.0, 2.0, 3.0]\n")
    assert reference() == (1.0, 2.0, 3.0)


@pytest.mark.parametrize("path", sorted((config_folder() / "venues").glob("*.toml")), ids=lambda path: path.stem)
def test_every_shipped_venue_has_a_reference_of_its_light(path: Path) -> None:
    assert load_settings(venue=path.stem).colors.light.reference_bgr is not None


def test_a_missing_file_is_named() -> None:
    with pytest.raises(SettingsError, match="nowhere.toml; found: No such file"):
        load_settings("nowhere.toml")


@pytest.mark.parametrize("name", ["x" * 300, "x" * 300 + ".toml", "\0.toml"], ids=["name", "path", "nul"])
def test_a_name_that_no_file_can_have_is_refused(name: str) -> None:
    with pytest.raises(SettingsError):
        load_settings(options={"field_preset": name})
    with pytest.raises(SettingsError):
        load_settings(name)


def test_an_unknown_venue_lists_the_known_ones() -> None:
    with pytest.raises(SettingsError, match="venue 'moon'; found: no such file; accepted: .*a path"):
        find_file("venues", "moon")


def test_the_schema_tells_ranges() -> None:
    schema = msgspec.json.schema(Settings)
    assert schema["$defs"]["CameraSettings"]["properties"]["width_px"]["minimum"] == 64


def test_a_corner_far_outside_of_the_picture_is_a_slip(tmp_path: Path) -> None:
    text = (config_folder() / "minimal.toml").read_text()
    venue = tmp_path / "venue.toml"
    venue.write_text(text.replace("[1200.0, 30.0]", "[12000.0, 30.0]"))
    with pytest.raises(
        SettingsError, match=r"found: 'right top corner' at \(12000, 30\) px; accepted: points in or near"
    ):
        load_settings(str(venue))

"""Samples are written into a file that people edit: everything else in it stays."""

import stat
import tomllib
from pathlib import Path

import pytest

from vision_core.errors import SettingsError
from vision_core.venues.palette_edit import sample_line, sample_table, save_samples

SAMPLES = {"orange": ("#ff8000", "#e07000"), "Orange ball": ("#ff8001",)}


def saved(tmp_path: Path, text: str, name: str = "orange") -> str:
    path = tmp_path / "venue.toml"
    path.write_text(text)
    path.chmod(0o640)
    save_samples(path, text, SAMPLES, name)
    assert stat.S_IMODE(path.stat().st_mode) == 0o640
    assert list(tmp_path.iterdir()) == [path]
    return path.read_text()


def test_any_name_makes_a_line_that_can_be_read() -> None:
    for name in ("orange", "Orange ball", 'a"b', "größe"):
        assert tomllib.loads(sample_line(name, ["#ff8000"])) == {name: ["#ff8000"]}
    assert tomllib.loads(sample_table(SAMPLES)) == {
        "colors": {"samples": {name: list(colors) for name, colors in SAMPLES.items()}}
    }


def test_a_file_without_samples_gets_the_table_at_its_end(tmp_path: Path) -> None:
    assert saved(tmp_path, "") == sample_table(SAMPLES) + "\n"
    assert saved(tmp_path, "# mine\n[server]\nport = 9000") == (
        "# mine\n[server]\nport = 9000\n\n" + sample_table(SAMPLES) + "\n"
    )


def test_one_class_is_added_or_replaced_in_its_place(tmp_path: Path) -> None:
    before = '[colors.samples]    # mine\nblue = ["#0000ff"]   # deep\n\n[server]\nport = 9000\n'
    after = saved(tmp_path, before)
    line = sample_line("orange", SAMPLES["orange"])
    assert after == before.replace("# deep\n", f"# deep\n{line}\n")
    assert saved(tmp_path, after) == after
    assert saved(tmp_path, after.replace(line, 'orange = [\n  "#111111",\n]')) == after


def test_a_table_in_another_form_is_left_alone(tmp_path: Path) -> None:
    text = 'colors.samples = { orange = ["#111111"] }\n'
    with pytest.raises(SettingsError, match=r"found: colors.samples in another form; accepted: .*orange = "):
        saved(tmp_path, text)
    assert (tmp_path / "venue.toml").read_text() == text

"""pslv passwd and pslv token."""

from pathlib import Path

from typer.testing import CliRunner

from app.cli import app
from app.web.auth.identity import Role
from app.web.auth.people import People
from vision_core.errors import PslvError


def run(folder: Path, *arguments: str, typed: str = "") -> tuple[int, str]:
    done = CliRunner().invoke(app, [*arguments, "--database", str(folder)], input=typed)
    return done.exit_code, str(done.exception) if isinstance(done.exception, PslvError) else done.output


def test_a_password_is_set_and_first_run_links_end(tmp_path: Path) -> None:
    people = People(tmp_path / "people.db")
    link = people.first_run_token()
    assert link is not None
    assert people.whose_random(link) is not None
    assert run(tmp_path, "passwd", typed="a long password\n")[0] == 0
    assert people.whose_random(link) is None
    found = people.whose_password("a long password")
    assert found is not None
    assert found.role is Role.OPERATOR
    people.close()


def test_a_simple_password_is_refused(tmp_path: Path) -> None:
    for typed in ("123456", "777777", "short", "12345"):
        code, words = run(tmp_path, "passwd", typed=f"{typed}\n")
        assert code != 0
        assert "or a PIN of 6 digits" in words


def test_tokens_are_made_listed_and_revoked(tmp_path: Path) -> None:
    assert run(tmp_path, "token", "scoreboard")[1].startswith("pslv_")
    assert run(tmp_path, "token", "--list")[1] == "1  scoreboard  last used: never\n"
    assert run(tmp_path, "token", "--revoke", "1")[0] == 0
    assert run(tmp_path, "token", "--list")[1] == ""
    assert "accepted: none" in run(tmp_path, "token", "--revoke", "1")[1]

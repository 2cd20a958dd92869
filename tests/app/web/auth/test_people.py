"""People: passwords, sessions, tokens, keys and the audit log, as the file keeps them."""

import stat
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.web.auth import audit
from app.web.auth.audit import Kind
from app.web.auth.hashing import hash_password, is_password
from app.web.auth.identity import Identity, Role
from app.web.auth.people import IDLE_S, People

OPERATOR = Identity(Role.OPERATOR, "operator")
PASSWORD = "a long password"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "private" / "people.db"


@pytest.fixture
def people(path: Path) -> Iterator[People]:
    people = People(path)
    yield people
    people.close()


def test_the_file_is_the_owners_and_holds_no_secret(path: Path, people: People) -> None:
    people.set_password(Role.OPERATOR, PASSWORD)
    secrets = [
        PASSWORD,
        people.new_token("scoreboard")[1],
        people.team_keys.renew("cgn"),
        people.open_session(OPERATOR),
    ]
    for file in path.parent.iterdir():
        assert stat.S_IMODE(file.stat().st_mode) == 0o600, file.name
        content = file.read_bytes()
        assert not any(secret.encode() in content for secret in secrets), file.name
    assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700


def test_a_session_survives_a_restart_and_ends_without_use(
    path: Path, people: People, monkeypatch: pytest.MonkeyPatch
) -> None:
    secret = people.open_session(OPERATOR)
    again = People(path)
    assert again.of_session(secret) == (OPERATOR, False)
    later = time.time() + IDLE_S + 1.0
    monkeypatch.setattr(time, "time", lambda: later)
    assert again.of_session(secret) is None
    again.close()


def test_use_keeps_a_session(people: People, monkeypatch: pytest.MonkeyPatch) -> None:
    secret, began = people.open_session(OPERATOR), time.time()
    for hours in (8.0, 16.0, 24.0):
        monkeypatch.setattr(time, "time", lambda hours=hours: began + hours * 3600.0)
        assert people.of_session(secret) == (OPERATOR, True)
        people.touch_session(secret)


def test_a_new_password_ends_the_sessions_of_its_role_but_ones_own(people: People) -> None:
    own, other = people.open_session(OPERATOR), people.open_session(OPERATOR)
    viewer = people.open_session(Identity(Role.VIEWER, "viewer"))
    people.set_password(Role.OPERATOR, PASSWORD, keep_session=own)
    assert [people.of_session(secret) is not None for secret in (own, other, viewer)] == [True, False, True]


def test_each_password_opens_its_own_role(people: People) -> None:
    people.set_password(Role.OPERATOR, PASSWORD)
    people.set_password(Role.VIEWER, "274951")
    assert people.whose_password(PASSWORD) == OPERATOR
    assert people.whose_password("274951") == Identity(Role.VIEWER, "viewer")
    for wrong in ("", "A long password", PASSWORD + " ", "a" * 100_000, "\ud800", "\0"):
        assert people.whose_password(wrong) is None
        assert people.whose_random(wrong) is None


def test_a_new_key_ends_what_was_opened_with_the_old_one(people: People) -> None:
    old = people.team_keys.renew("cgn")
    team = people.whose_random(old)
    assert team is not None
    assert (team.role, team.team) == (Role.TEAM, "cgn")
    session = people.open_session(team)
    new = people.team_keys.renew("cgn")
    assert people.whose_random(old) is None
    assert people.of_session(session) is None
    assert people.whose_random(new) == team
    people.team_keys.forget("cgn")
    assert people.whose_random(new) is None


def test_a_revoked_token_is_worthless_at_once(path: Path, people: People) -> None:
    token, secret = people.new_token("scoreboard")
    service = People(path)
    assert service.of_token(secret) == (Identity(Role.OPERATOR, "token scoreboard"), True)
    people.revoke_token(token.id)
    assert service.of_token(secret) is None
    service.close()


def test_a_damaged_file_is_set_aside_and_nobody_is_locked_out(path: Path) -> None:
    people = People(path)
    people.set_password(Role.OPERATOR, PASSWORD)
    people.close()
    path.write_bytes(b"no database" * 1000)
    people = People(path)
    assert "is damaged" in people.notice
    assert people.whose_password(PASSWORD) == OPERATOR
    people.close()


def test_a_flood_of_failures_hides_no_change(people: People, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(audit, "ROOM", 5)
    people.audit.note(Kind.SECRET, "operator", "10.0.0.1", "make token scoreboard")
    for n in range(20):
        people.audit.note(Kind.FAILURE, "unknown", f"10.0.1.{n}", "log in")
        people.audit.note(Kind.FAILURE, "unknown", "10.0.0.9", "log in")
    entries = people.audit.entries(100)
    assert len([entry for entry in entries if entry.kind is Kind.FAILURE]) <= 6
    assert [entry.what for entry in entries if entry.kind is Kind.SECRET] == ["make token scoreboard"]


def test_guessing_a_password_is_expensive() -> None:
    stored = hash_password(PASSWORD)
    assert stored.startswith("$argon2id$v=19$m=32768,t=3,p=1$")
    assert is_password(stored, PASSWORD)
    assert not is_password("no hash", PASSWORD)

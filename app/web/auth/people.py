"""The people of the page: their passwords, sessions and tokens."""

import time
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from app.web.auth.audit import AuditLog
from app.web.auth.hashing import (
    MAX_SECRET,
    TOKEN_PREFIX,
    digest,
    hash_password,
    is_password,
    is_same,
    new_secret,
)
from app.web.auth.identity import Identity, Role
from app.web.auth.people_file import PeopleFile
from app.web.auth.team_keys import TeamKeys
from vision_core.errors import PslvError

IDLE_S = 12 * 3600.0
"""A session that was not used for so long has ended."""
TOUCH_S = 60.0
"""When a session or token was used last is written at most this often."""
MAX_SESSIONS = 1000
MAX_TOKENS = 100
FIRST_RUN_TOKENS = 8
"""Services that were started without a password, whose links are still good."""
MIN_PASSWORD = 8
MIN_PIN = 6
MAX_NAME = 60
PASSWORD_RULE = f"{MIN_PASSWORD} characters or more, or a PIN of {MIN_PIN} digits or more that is no row like 123456"


@dataclass(frozen=True, slots=True)
class Token:
    """A token of a script, without its secret."""

    id: int
    name: str
    role: Role
    made_at: float
    """Unix time [s]."""
    used_at: float | None
    """Unix time [s], to about a minute; None: never."""


class People:
    """Everybody that the page knows. Threads may share it."""

    def __init__(self, path: Path) -> None:
        """path: of ``people.db``. Raises ServiceError when it cannot be opened."""
        self._file = PeopleFile(path)
        self.notice = self._file.notice
        self.team_keys = TeamKeys(self._file)
        self.audit = AuditLog(self._file)

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def has_password(self, role: Role) -> bool:
        """Has a role a password?"""
        return self._file.row("SELECT 1 FROM passwords WHERE role = ?", role) is not None

    def set_password(self, role: Role, password: str, keep_session: str = "") -> None:
        """Give operator or viewer a password. Sessions of the role end but ``keep_session``; first-run links too.

        Takes as long as hashing. Raises PslvError when the password is too simple.
        """
        check_password(password)
        stored = hash_password(password)
        with self._file.writing() as connection:
            connection.execute("INSERT OR REPLACE INTO passwords VALUES (?, ?, ?)", (role, stored, time.time()))
            connection.execute("DELETE FROM sessions WHERE role = ? AND hash != ?", (role, digest(keep_session)))
            if role is Role.OPERATOR:
                connection.execute("DELETE FROM first_run")

    def first_run_token(self) -> str | None:
        """A new token for the link that a service prints; None when the operator has a password."""
        if self.has_password(Role.OPERATOR):
            return None
        token = new_secret()
        with self._file.writing() as connection:
            connection.execute("INSERT INTO first_run VALUES (?, ?)", (digest(token), time.time()))
            connection.execute(
                "DELETE FROM first_run WHERE hash NOT IN (SELECT hash FROM first_run ORDER BY made DESC LIMIT ?)",
                (FIRST_RUN_TOKENS,),
            )
        return token

    def whose_random(self, secret: str) -> Identity | None:
        """Who has this random secret: a first-run token or a team's key; None: nobody. It takes no time."""
        computed = digest(secret)
        row = self._file.row("SELECT hash FROM first_run WHERE hash = ?", computed)
        if row and is_same(row[0], computed) and not self.has_password(Role.OPERATOR):
            return Identity(Role.OPERATOR, "operator")
        team = self.team_keys.team_of(secret)
        return Identity(Role.TEAM, f"team {team}", team) if team else None

    def whose_password(self, secret: str) -> Identity | None:
        """Who has this password or PIN; None: nobody. Takes as long as hashing for each role that has one."""
        if len(secret) > MAX_SECRET:
            return None
        for role in (Role.OPERATOR, Role.VIEWER):
            row = self._file.row("SELECT hash FROM passwords WHERE role = ?", role)
            if row and is_password(row[0], secret):
                return Identity(role, role.value)
        return None

    def open_session(self, identity: Identity) -> str:
        """A new session; returns the secret for its cookie."""
        secret, now = new_secret(), time.time()
        with self._file.writing(copy=False) as connection:
            connection.execute("DELETE FROM sessions WHERE seen < ?", (now - IDLE_S,))
            connection.execute(
                "DELETE FROM sessions WHERE hash IN (SELECT hash FROM sessions ORDER BY seen DESC LIMIT -1 OFFSET ?)",
                (MAX_SESSIONS - 1,),
            )
            values = (digest(secret), identity.role, identity.name, identity.team, now, now)
            connection.execute("INSERT INTO sessions VALUES (?, ?, ?, ?, ?, ?)", values)
        return secret

    def end_session(self, secret: str) -> None:
        """End a session; one that there is not is ended already."""
        with self._file.writing(copy=False) as connection:
            connection.execute("DELETE FROM sessions WHERE hash = ?", (digest(secret),))

    def of_session(self, secret: str) -> tuple[Identity, bool] | None:
        """Whose session it is, and whether ``touch_session`` is due; None when it ended, or never was."""
        computed, now = digest(secret), time.time()
        row = self._file.row("SELECT hash, role, name, team, seen FROM sessions WHERE hash = ?", computed)
        if row is None or not is_same(row[0], computed) or now - row[4] > IDLE_S:
            return None
        return Identity(Role(row[1]), row[2], row[3]), now - row[4] > TOUCH_S

    def touch_session(self, secret: str) -> None:
        """Note that a session is used now."""
        with self._file.writing(copy=False) as connection:
            connection.execute("UPDATE sessions SET seen = ? WHERE hash = ?", (time.time(), digest(secret)))

    def new_token(self, name: str, role: Role = Role.OPERATOR) -> tuple[Token, str]:
        """A token for a script, and its secret, which is told once. Raises PslvError when there are too many."""
        name = " ".join(name.split())
        if not 0 < len(name) <= MAX_NAME or not name.isprintable():
            raise PslvError("a token's name", found=f"{len(name)} characters", accepted=f"1 to {MAX_NAME}, printable")
        if len(self.tokens()) >= MAX_TOKENS:
            raise PslvError("a new token", found=f"{MAX_TOKENS} of them", accepted="one after another is revoked")
        secret, now = new_secret(TOKEN_PREFIX), time.time()
        with self._file.writing() as connection:
            cursor = connection.execute(
                "INSERT INTO tokens (name, role, hash, made) VALUES (?, ?, ?, ?)", (name, role, digest(secret), now)
            )
            assert cursor.lastrowid is not None
            return Token(cursor.lastrowid, name, role, now, None), secret

    def tokens(self) -> list[Token]:
        """All tokens, the oldest first."""
        rows = self._file.rows("SELECT id, name, role, made, used FROM tokens ORDER BY id")
        return [Token(number, name, Role(role), made, used) for number, name, role, made, used in rows]

    def revoke_token(self, number: int) -> Token | None:
        """Make a token worthless; None: there is none of this number."""
        token = next((each for each in self.tokens() if each.id == number), None)
        if token is None:
            return None
        with self._file.writing() as connection:
            connection.execute("DELETE FROM tokens WHERE id = ?", (number,))
        return token

    def of_token(self, secret: str) -> tuple[Identity, bool] | None:
        """Whose token it is, and whether ``touch_token`` is due; None: nobody's."""
        computed = digest(secret)
        row = self._file.row("SELECT hash, name, role, used FROM tokens WHERE hash = ?", computed)
        if row is None or not is_same(row[0], computed):
            return None
        return Identity(Role(row[2]), f"token {row[1]}"), time.time() - (row[3] or 0.0) > TOUCH_S

    def touch_token(self, secret: str) -> None:
        """Note that a token is used now."""
        with self._file.writing(copy=False) as connection:
            connection.execute("UPDATE tokens SET used = ? WHERE hash = ?", (time.time(), digest(secret)))


def check_password(password: str) -> None:
    """Raises PslvError for a password that is too short, or a PIN that everybody tries first."""
    enough = MIN_PIN if password.isdecimal() else MIN_PASSWORD
    if len(password) < enough:
        raise PslvError("a password", found=f"{len(password)} characters", accepted=PASSWORD_RULE)
    if len(password) > MAX_SECRET:
        raise PslvError("a password", found=f"{len(password)} characters", accepted=f"{MAX_SECRET} at most")
    steps = {ord(after) - ord(before) for before, after in pairwise(password)}
    if len(steps) == 1 and steps <= {-1, 0, 1}:
        raise PslvError("a password", found="a row of the same or neighboring characters", accepted=PASSWORD_RULE)

"""What somebody came with: the secret of a session or token, which can become worthless while he is connected."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass

from starlette.requests import HTTPConnection

from app.web.auth.identity import Identity

SCOPE_KEY = "pslv.credential"
CHECK_EVERY_S = 0.5


LOGIN_ENDED = "your login has ended: log in again"


@dataclass(frozen=True, slots=True)
class Credential:
    """A session's or token's secret, and how it is looked up."""

    secret: str
    find: Callable[[str], tuple[Identity, bool] | None]
    """Whose it is, and whether ``touch`` is due; None: nobody's."""
    touch: Callable[[str], None]
    """Note that it is used now."""

    async def identity(self) -> Identity | None:
        """Whose it is at this moment; None: nobody's."""
        found = self.find(self.secret)
        if found is None:
            return None
        identity, is_touch_due = found
        if is_touch_due:
            await asyncio.to_thread(self.touch, self.secret)
        return identity


async def until_login_ends(connection: HTTPConnection) -> None:
    """Return when the login with which a connection was opened has ended; never for who came without one."""
    credential: Credential | None = connection.scope.get(SCOPE_KEY)
    if credential is None:
        await asyncio.Event().wait()
    while credential is not None and await credential.identity() is not None:
        await asyncio.sleep(CHECK_EVERY_S)

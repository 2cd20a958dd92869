"""``/api/v1/password``, ``tokens``, ``audit``: secrets, and who did what."""

from dataclasses import asdict
from http import HTTPStatus

from fastapi import APIRouter, Query, Request
from pydantic import ConfigDict, Field

from app.web.auth.addresses import address_of
from app.web.auth.audit import Kind
from app.web.auth.hashing import MAX_SECRET
from app.web.auth.identity import Role, identity_of
from app.web.auth.people import MAX_NAME, People
from app.web.middleware.gate import cookie_name, session_of
from app.web.problems import REFUSED, RequestRefused
from app.web.reports.base import Report
from vision_core.errors import PslvError


class Password(Report):
    """A new password or PIN."""

    model_config = ConfigDict(extra="forbid")

    password: str = Field(max_length=MAX_SECRET)
    role: Role = Role.OPERATOR
    """Whose: operator or viewer."""


class TokenReport(Report):
    """A token of a script, without its secret."""

    id: int
    name: str
    role: Role
    made_at: float
    """Seconds since 1970."""
    used_at: float | None
    """null: never."""


class NewToken(Report):
    """A token with its secret, which is told only once."""

    token: TokenReport
    secret: str


class TokenRequest(Report):
    """A token to be made."""

    model_config = ConfigDict(extra="forbid")

    name: str = Field(min_length=1, max_length=MAX_NAME)


class AuditReport(Report):
    """What somebody did."""

    kind: Kind
    first_at: float
    """Seconds since 1970."""
    last_at: float
    times: int
    who: str
    address: str
    what: str


def people_routes(people: People) -> APIRouter:
    """Passwords, tokens, and who did what."""
    router = APIRouter(prefix="/api/v1", tags=["people"])

    @router.put("/password", responses=REFUSED, status_code=HTTPStatus.NO_CONTENT)
    def password(wanted: Password, request: Request) -> None:
        """Sets the operator's or the viewers' password or PIN; other sessions of this role end."""
        keep = session_of(request.headers, cookie_name(request.scope))
        if wanted.role is Role.TEAM:
            raise RequestRefused(
                HTTPStatus.UNPROCESSABLE_ENTITY, "a password", found="team", accepted="operator, viewer", field="role"
            )
        try:
            people.set_password(wanted.role, wanted.password, keep)
        except PslvError as error:
            raise RequestRefused(
                HTTPStatus.UNPROCESSABLE_ENTITY,
                error.asked,
                found=error.found,
                accepted=error.accepted,
                field="password",
            ) from None
        _note(request, f"set the password of the {wanted.role.value}")

    @router.get("/tokens", responses=REFUSED)
    def tokens() -> list[TokenReport]:
        """The tokens of scripts."""
        return [TokenReport(**asdict(token)) for token in people.tokens()]

    @router.post("/tokens", responses=REFUSED, status_code=HTTPStatus.CREATED)
    def new_token(wanted: TokenRequest, request: Request) -> NewToken:
        """Makes a token, with which a script may do what the operator may."""
        try:
            token, secret = people.new_token(wanted.name)
        except PslvError as error:
            raise RequestRefused(
                HTTPStatus.UNPROCESSABLE_ENTITY, error.asked, found=error.found, accepted=error.accepted, field="name"
            ) from None
        _note(request, f"make token {token.name}")
        return NewToken(token=TokenReport(**asdict(token)), secret=secret)

    @router.delete("/tokens/{number}", responses=REFUSED, status_code=HTTPStatus.NO_CONTENT)
    def revoke(number: int, request: Request) -> None:
        """Makes a token worthless."""
        token = people.revoke_token(number)
        if token is None:
            accepted = ", ".join(str(each.id) for each in people.tokens()) or "a token must be made first"
            raise RequestRefused(HTTPStatus.NOT_FOUND, "a token", found=str(number)[:40], accepted=accepted)
        _note(request, f"revoke token {token.name}")

    @router.get("/audit", responses=REFUSED)
    def audit(limit: int = Query(default=200, ge=1, le=1000)) -> list[AuditReport]:
        """Who logged in, who failed to, and who set or withdrew a secret, the newest first."""
        return [AuditReport(**asdict(entry)) for entry in people.audit.entries(limit)]

    def _note(request: Request, what: str) -> None:
        people.audit.note(Kind.SECRET, identity_of(request).name, address_of(request.scope), what)

    return router

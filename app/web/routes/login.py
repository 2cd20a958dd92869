"""``/api/v1/login``, ``logout``, ``me``: who asks."""

import asyncio
import math
from http import HTTPStatus
from typing import Any

from fastapi import APIRouter, Request, Response
from fastapi.responses import JSONResponse
from pydantic import ConfigDict, Field

from app.web.auth.addresses import address_of, share_of
from app.web.auth.attempts import Attempts
from app.web.auth.audit import Kind
from app.web.auth.hashing import MAX_SECRET
from app.web.auth.identity import Identity, Role, identity_of
from app.web.auth.people import People
from app.web.configuration.configuration import Configuration
from app.web.configuration.keys import TEAM, plays
from app.web.middleware.gate import cookie_name, session_of
from app.web.problems import PROBLEM, REFUSED, RequestRefused, problem_response
from app.web.reports.base import Report
from vision_core.types.objects import Team

HASHING_AT_ONCE = 2
MAX_WAITING = 16
"""Logins that may wait for hashing; more are asked to come again."""
DAY_S = 24 * 3600
WAIT = "Too many failures; the header Retry-After says when to try again"
TOO_OFTEN: dict[int | str, Any] = {429: PROBLEM | {"description": WAIT}}


class Me(Report):
    """Who asks."""

    role: Role
    name: str
    team: str | None
    """Slug of the team, for the role team."""
    plays: Team | None
    """The color that the team plays; null: it is not on the field."""
    must_set_password: bool
    """No operator's password is set yet."""


class Login(Report):
    """A secret: the operator's or viewers' password or PIN, a first-run token, or a team's key."""

    model_config = ConfigDict(extra="forbid")

    secret: str = Field(max_length=MAX_SECRET)


def login_routes(people: People, configuration: Configuration) -> APIRouter:
    """Logging in and out."""
    router = APIRouter(prefix="/api/v1", tags=["people"])
    attempts, hashing = Attempts(), asyncio.Semaphore(HASHING_AT_ONCE)
    waiting: set[object] = set()

    def me_of(identity: Identity) -> Me:
        entries = configuration.entries
        color = next((color for color in Team if identity.team and entries.get(plays(color)) == identity.team), None)
        name = entries[f"{TEAM}{identity.team}"]["name"] if f"{TEAM}{identity.team}" in entries else identity.name
        must = not people.has_password(Role.OPERATOR)
        return Me(role=identity.role, name=name, team=identity.team, plays=color, must_set_password=must)

    @router.get("/me")
    def me(request: Request) -> Me:
        """Who asks, and what he may."""
        return me_of(identity_of(request))

    @router.post("/login", responses=REFUSED | TOO_OFTEN, response_model=Me)
    async def login(login: Login, request: Request) -> Response:
        """Opens a session by a password, PIN, first-run token or team's key; answers with its cookie."""
        address = address_of(request.scope)
        share = share_of(address)
        wait_s = attempts.wait_s(share)
        if wait_s > 0.0 or len(waiting) >= MAX_WAITING:
            return _too_often(request, wait_s or 1.0)
        attempts.begin(share)
        ticket = object()
        waiting.add(ticket)
        try:
            async with hashing:
                found = people.whose_random(login.secret) or await asyncio.to_thread(
                    people.whose_password, login.secret
                )
        finally:
            waiting.discard(ticket)
        if found is None:
            await asyncio.to_thread(people.audit.note, Kind.FAILURE, "unknown", address, "log in")
            raise RequestRefused(
                HTTPStatus.UNAUTHORIZED,
                "log in",
                found="a password, PIN or key that nobody has",
                accepted="the operator's or viewers' password or PIN, or a team's key",
                field="secret",
            )
        attempts.succeeded(share)
        secret = await asyncio.to_thread(people.open_session, found)
        await asyncio.to_thread(people.audit.note, Kind.LOGIN, found.name, address, f"log in as {found.role.value}")
        answer = JSONResponse(me_of(found).model_dump(mode="json"))
        answer.set_cookie(
            cookie_name(request.scope),
            secret,
            max_age=7 * DAY_S,
            httponly=True,
            samesite="strict",
            secure=request.headers.get("origin", "").startswith("https://"),  # behind a proxy we see http
        )
        return answer

    @router.post("/logout", status_code=HTTPStatus.NO_CONTENT)
    def logout(request: Request, response: Response) -> None:
        """Ends the session."""
        name = cookie_name(request.scope)
        if secret := session_of(request.headers, name):
            people.end_session(secret)
        response.delete_cookie(name)

    return router


def _too_often(request: Request, wait_s: float) -> Response:
    seconds = math.ceil(wait_s)
    words = f"too many tries from your address; try again in {seconds} s"
    answer = problem_response(request, HTTPStatus.TOO_MANY_REQUESTS, words)
    answer.headers["retry-after"] = str(seconds)
    return answer

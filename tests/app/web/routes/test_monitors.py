"""The monitors' key over the API: made, published by its digest only, no login, withdrawn."""

import httpx

from tests.app.fake_service import FakeService
from vision_core.protocol.proofs import key_digest
from vision_core.rtdb import records


def published(service: FakeService) -> str | None:
    """The digest that the task ``serve`` is told."""
    reading = records.LIVE_SETTINGS.reader(service.store).read(service.clock.now())
    assert reading is not None
    return reading.value.monitor_key


def test_a_key_is_made_replaced_and_withdrawn(operator: httpx.Client, service: FakeService) -> None:
    assert operator.get("/monitors").json() == {"has_key": False, "connected": []}
    first, second = (operator.post("/monitors/key").json()["key"] for _ in range(2))
    assert published(service) == key_digest(second) != key_digest(first)
    assert operator.get("/monitors").json()["has_key"]
    assert operator.delete("/monitors/key").status_code == 204
    assert published(service) is None
    assert not operator.get("/monitors").json()["has_key"]


def test_it_opens_no_page(operator: httpx.Client) -> None:
    key = operator.post("/monitors/key").json()["key"]
    assert operator.post("/login", json={"secret": key}, headers={"Authorization": ""}).status_code == 401


def test_who_is_not_the_operator_makes_none(operator: httpx.Client) -> None:
    assert operator.post("/monitors/key", headers={"Authorization": ""}).status_code == 401

"""The whole API answers generated requests of an operator as its OpenAPI document says, and never with a bug."""

from collections import Counter
from collections.abc import Iterator
from typing import Any

import hypothesis
import pytest
import schemathesis
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import response_schema_conformance, status_code_conformance

from tests.app.fake_service import FakeService, Scene, running_service, served_page

pytestmark = pytest.mark.slow
EXAMPLES = 12
"""Generated requests for each operation."""
NO_MORE_THAN_S = 5.0
CHECKS = [not_a_server_error, status_code_conformance, response_schema_conformance]
UNAVAILABLE = {503}
"""Documented refusals of a service that has no picture or is not ready; the first check takes them for bugs."""


@pytest.fixture(scope="module")
def service() -> Iterator[FakeService]:
    with running_service(Scene(clients=2)) as service:
        yield service


@pytest.fixture(scope="module")
def address(service: FakeService) -> Iterator[str]:
    with served_page(service, "/readyz") as address:
        yield address


@pytest.mark.timeout(400)
def test_generated_requests_are_answered_as_documented(service: FakeService, address: str) -> None:
    schema = schemathesis.openapi.from_url(f"http://{address}/openapi.json")
    wrong: dict[str, str] = {}
    codes: Counter[int] = Counter()
    for found in schema.get_all_operations():
        operation = found.ok()  # type: ignore[union-attr]  # an error raises here
        if operation.path in {"/api/v1/logout", "/api/v1/password", "/api/v1/tokens/{number}"}:  # end what others need
            continue

        @hypothesis.settings(
            max_examples=EXAMPLES,
            deadline=None,
            database=None,
            suppress_health_check=list(hypothesis.HealthCheck),
            phases=[hypothesis.Phase.generate],
            derandomize=True,
        )
        @hypothesis.given(case=operation.as_strategy())
        def ask(case: schemathesis.Case[Any]) -> None:
            response = case.call(headers=service.operator, timeout=NO_MORE_THAN_S)
            codes[response.status_code] += 1
            if response.status_code not in UNAVAILABLE:
                case.validate_response(response, checks=CHECKS)

        try:
            ask()
        except Exception as problem:  # noqa: BLE001 (all operations are tried, then all problems told)
            wrong[f"{operation.method.upper()} {operation.path}"] = str(problem)[:1500]
    assert not wrong, "\n\n".join(f"{name}: {problem}" for name, problem in wrong.items())
    assert codes.total() > 200
    assert codes[401] <= EXAMPLES, "only wrong logins; the token is good"

"""Two computers and a cable, as network namespaces: interfaces and addresses that come and go, and attacks."""

import shutil
import subprocess
import sys
from types import ModuleType

import pytest

from tests.client.test_command import environment
from tests.net import attack_scenes, namespace_scenes

pytestmark = pytest.mark.slow

OWN = ["unshare", "-rn"]


@pytest.fixture(scope="module")
def own_network() -> list[str]:
    """What runs a command in a network of its own; skips where the system does not allow that."""
    if not all(map(shutil.which, ("unshare", "nsenter", "ip"))):
        pytest.skip("unshare, nsenter or ip is missing")
    tried = subprocess.run(
        [*OWN, "ip", "link", "add", "one", "type", "veth", "peer", "name", "other"], capture_output=True, check=False
    )
    if tried.returncode:
        pytest.skip(f"no network of its own: {tried.stderr.decode().strip()}")
    return OWN


@pytest.mark.parametrize(
    ("module", "scene"), [(module, name) for module in (namespace_scenes, attack_scenes) for name in module.SCENES]
)
def test_a_scene(module: ModuleType, scene: str, own_network: list[str]) -> None:
    command = [*own_network, sys.executable, "-m", module.__name__, scene]
    played = subprocess.run(command, env=environment(), capture_output=True, text=True, check=False)
    assert (played.returncode, played.stdout) == (0, f"{scene}\n"), played.stderr

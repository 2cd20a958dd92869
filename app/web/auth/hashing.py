"""Secrets are kept as hashes only: random ones by SHA-256, those that people choose by argon2id.

A random secret has 256 bits, so nobody finds it from its hash, however fast the hash is. A password can be guessed, so
each guess must be expensive: 32 MiB and about 60 ms of processor time, on one core: the vision keeps the others.
"""

import hashlib
import secrets

from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerificationError

RANDOM_BYTES = 32
MAX_SECRET = 256
"""Characters; nobody types more, and hashing takes time."""
TOKEN_PREFIX = "pslv_"  # noqa: S105 (it makes a token known to scanners of leaked secrets)

_hasher = PasswordHasher(time_cost=3, memory_cost=32 * 1024, parallelism=1)


def new_secret(prefix: str = "") -> str:
    """A random secret of 256 bits, fit for addresses and headers."""
    return prefix + secrets.token_urlsafe(RANDOM_BYTES)


def digest(secret: str) -> str:
    """What is stored of a random secret."""
    return hashlib.sha256(_bytes(secret)).hexdigest()


def is_same(stored: str, computed: str) -> bool:
    """Compare two digests in a time that does not depend on where they differ."""
    return secrets.compare_digest(stored, computed)


def hash_password(password: str) -> str:
    """What is stored of a password. Takes about 60 ms of processor time."""
    return _hasher.hash(_bytes(password))


def is_password(stored: str, password: str) -> bool:
    """Does a password have this hash? Takes about 60 ms of processor time."""
    try:
        return _hasher.verify(stored, _bytes(password))
    except (VerificationError, InvalidHashError):
        return False


def _bytes(secret: str) -> bytes:
    """A stranger may send half a character; it is wrong like any other secret."""
    return secret.encode("utf-8", "surrogatepass")

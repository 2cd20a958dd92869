"""Takes secrets and contacts out of what leaves the house.

Values are taken out by the name of their field, and by their form wherever they stand: random secrets as the service
makes them, what follows ``token=`` and the like, the name and password in an address, and e-mail addresses.
"""

import re
from collections.abc import Mapping
from typing import Any

from app.web.auth.hashing import RANDOM_BYTES, TOKEN_PREFIX

TAKEN_OUT = "(taken out)"
PRIVATE = frozenset({"contact", "email", "password", "pin", "secret", "token", "hash"})
"""Names of fields whose values are taken out."""
RANDOM_CHARACTERS = -(-RANDOM_BYTES * 8 // 6)
"""Of a random secret, which is written with 6 bits a character."""
_RANDOM = re.compile(rf"(?<![\w-])(?:{TOKEN_PREFIX})?[\w-]{{{RANDOM_CHARACTERS}}}(?![\w-])", re.ASCII)
_NAMED = re.compile(r"\b(token|key|secret|password|pin)=[^\s&\"']+", re.IGNORECASE)
_BEARER = re.compile(r"\b(bearer) +[^\s\"']+", re.IGNORECASE)
_IN_ADDRESS = re.compile(r"(?<=://)[^/\s@]+(?=@)")
_EMAIL = re.compile(r"[\w.+-]+@[\w-]+(\.[\w-]+)+")


def without_secrets(value: Any) -> Any:
    """A value of JSON without secrets and contacts."""
    if isinstance(value, str):
        return _clean(value)
    if isinstance(value, Mapping):
        return {
            _clean(str(key)): TAKEN_OUT if str(key).lower() in PRIVATE and content else without_secrets(content)
            for key, content in value.items()
        }
    if isinstance(value, list | tuple):
        return [without_secrets(each) for each in value]
    return value


def _clean(text: str) -> str:
    text = _IN_ADDRESS.sub(TAKEN_OUT, text)
    text = _NAMED.sub(rf"\1={TAKEN_OUT}", text)
    text = _BEARER.sub(rf"\1 {TAKEN_OUT}", text)
    return _EMAIL.sub(TAKEN_OUT, _RANDOM.sub(_random, text))


def _random(found: re.Match[str]) -> str:
    """A word of that length is a secret when it has small and capital letters, as nearly all random ones have."""
    word = found[0]
    return TAKEN_OUT if word != word.lower() and word != word.upper() else word

"""Keys of teams, of which only hashes are kept."""

import hashlib
import secrets


class TeamKeys:
    """The keys of the registered teams, while this process runs."""

    def __init__(self) -> None:
        self._hashes: dict[str, bytes] = {}

    def renew(self, slug: str) -> str:
        """Make a new key for a team; it is told only once."""
        key = secrets.token_urlsafe(24)
        self._hashes[slug] = hashlib.sha256(key.encode()).digest()
        return key

    def has(self, slug: str) -> bool:
        """Has the team a key?"""
        return slug in self._hashes

    def forget(self, slug: str) -> None:
        """Delete a team's key."""
        self._hashes.pop(slug, None)

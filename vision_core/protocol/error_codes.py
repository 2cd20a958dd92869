"""Why a server refuses."""

from enum import StrEnum


class ErrorName(StrEnum):
    """Why a server refuses; fixed words, each fits in an ``(error ...)`` of 39 bytes."""

    ILLEGAL_FORM = "illegal_form"
    UNKNOWN_COMMAND = "unknown_command"
    ILLEGAL_TEAM = "illegal_team"
    ILLEGAL_NUMBER = "illegal_number"
    ILLEGAL_OPTION = "illegal_option"
    ILLEGAL_MIRROR = "illegal_mirror"
    NOT_ADMITTED = "not_admitted"
    ALREADY_CONNECTED = "already_connected"
    REPLACED = "replaced"
    SERVER_FULL = "server_full"
    NOT_CONNECTED = "not_connected"
    RATE_LIMITED = "rate_limited"


MEANINGS: dict[str, str] = {
    ErrorName.ILLEGAL_FORM: "brackets or words are not those of a command",
    ErrorName.UNKNOWN_COMMAND: "the server knows no such command",
    ErrorName.ILLEGAL_TEAM: "the team is neither blue nor yellow",
    ErrorName.ILLEGAL_NUMBER: "the match has no robot of this number",
    ErrorName.ILLEGAL_OPTION: "an option is unknown, given twice or out of its range",
    ErrorName.ILLEGAL_MIRROR: "A, B, C are no mirror, or one that is of no use on this field",
    ErrorName.NOT_ADMITTED: "the server does not serve this address (its key admission.subnets)",
    ErrorName.ALREADY_CONNECTED: "another computer controls this robot",
    ErrorName.REPLACED: "a newer client took this robot over",
    ErrorName.SERVER_FULL: "the server has no socket left",
    ErrorName.NOT_CONNECTED: "there is no such session",
    ErrorName.RATE_LIMITED: "too many requests at once: try again in a second",
}
"""What each error means, for people."""

"""The errors of ``(error ...)`` messages, and what each means."""

from enum import StrEnum


class ErrorCode(StrEnum):
    """Why a server refuses a request. Fixed words; each fits into an ``(error ...)`` of 39 bytes."""

    ILLEGAL_FORM = "illegal_form"
    UNKNOWN_COMMAND = "unknown_command"
    ILLEGAL_TEAM = "illegal_team"
    ILLEGAL_NUMBER = "illegal_number"
    ILLEGAL_OPTION = "illegal_option"
    ILLEGAL_MIRROR = "illegal_mirror"
    ILLEGAL_DRIVE = "illegal_drive"
    NO_DRIVE = "no_drive"
    NOT_ADMITTED = "not_admitted"
    ALREADY_CONNECTED = "already_connected"
    REPLACED = "replaced"
    WRONG_KEY = "wrong_key"
    SERVER_FULL = "server_full"
    NOT_CONNECTED = "not_connected"
    NOT_READY = "not_ready"
    RATE_LIMITED = "rate_limited"


TRANSIENT = frozenset({ErrorCode.NOT_CONNECTED, ErrorCode.NOT_READY, ErrorCode.RATE_LIMITED})
"""Errors after which a client repeats its init a second later; all others end the session or the attempt."""

MEANINGS: dict[str, str] = {
    ErrorCode.ILLEGAL_FORM: "the parentheses or words are not those of a command",
    ErrorCode.UNKNOWN_COMMAND: "the server does not know this command",
    ErrorCode.ILLEGAL_TEAM: "the team is neither blue nor yellow",
    ErrorCode.ILLEGAL_NUMBER: "the match has no robot of this number",
    ErrorCode.ILLEGAL_OPTION: "an option is unknown, given twice or out of its range",
    ErrorCode.ILLEGAL_MIRROR: "A, B, C are not those of a mirror, or the mirror does not suit this field",
    ErrorCode.ILLEGAL_DRIVE: "too fast for this robot, sideways on two wheels, or it lacks the kicker or dribbler",
    ErrorCode.NO_DRIVE: "no program drives this robot: it is real or recorded, or not on the simulated field",
    ErrorCode.NOT_ADMITTED: "the referee has not admitted this address: one click on the page Match does it",
    ErrorCode.ALREADY_CONNECTED: "another computer controls this robot",
    ErrorCode.REPLACED: "a newer client took this robot over",
    ErrorCode.WRONG_KEY: "this is not the key of the team, or of the monitors",
    ErrorCode.SERVER_FULL: "the server has no socket left",
    ErrorCode.NOT_CONNECTED: "there is no such session",
    ErrorCode.NOT_READY: "the server still prepares: try again in a second",
    ErrorCode.RATE_LIMITED: "too many requests: try again in a second",
}
"""What each error means, for people."""

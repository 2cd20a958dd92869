"""A socket filter in the kernel: what cannot be a command is dropped before it wakes the server.

Classic BPF (Linux socket(7), SO_ATTACH_FILTER). It keeps datagrams of at most 1024 bytes that begin with ``(`` or with
white space, which may stand before it; the server would drop all others unread (docs/protocol.md).
"""

import contextlib
import ctypes
import socket
import struct
from array import array
from collections.abc import Sequence

LONGEST = 1024
"""As ``protocol.commands.MAX_COMMAND``, which this module does not import: the standard library is enough [bytes]."""
SO_ATTACH_FILTER = 26
SO_MEMINFO = 55
"""Linux's numbers; the socket module does not name them."""
DROPS = 8
"""Index of the drops among the 32-bit numbers of SO_MEMINFO (sock_diag(7))."""
UDP_HEADER = 8
"""A filter of a UDP socket sees this header first [bytes]."""
LOAD_LENGTH, LOAD_BYTE = 0x80, 0x30
JUMP_EQUAL, JUMP_ABOVE, JUMP_AT_LEAST = 0x15, 0x25, 0x35
RETURN = 0x06
ALL = 0xFFFF
INSTRUCTION = struct.Struct("=HBBI")
"""Operation, instructions to skip if true and if false, operand."""
PROGRAM = (
    (LOAD_LENGTH, 0, 0, 0),
    (JUMP_ABOVE, 6, 0, UDP_HEADER + LONGEST),
    (LOAD_BYTE, 0, 0, UDP_HEADER),  # of an empty datagram: the kernel drops it
    (JUMP_EQUAL, 3, 0, ord("(")),
    (JUMP_EQUAL, 2, 0, ord(" ")),
    (JUMP_ABOVE, 2, 0, ord("\r")),
    (JUMP_AT_LEAST, 0, 1, ord("\t")),
    (RETURN, 0, 0, ALL),
    (RETURN, 0, 0, 0),
)


def attach_filter(opened: socket.socket) -> bool:
    """Let the kernel drop what cannot be a command; False where there is no such filter: the server drops it then."""
    return _attach(opened, PROGRAM)


def drop_all(opened: socket.socket) -> bool:
    """Let the kernel drop everything; False where there is no such filter: then the buffer fills and it drops."""
    return _attach(opened, PROGRAM[-1:])


def _attach(opened: socket.socket, instructions: Sequence[tuple[int, int, int, int]]) -> bool:
    code = b"".join(INSTRUCTION.pack(*instruction) for instruction in instructions)
    memory = ctypes.create_string_buffer(code, len(code))
    program = struct.pack("HP", len(instructions), ctypes.addressof(memory))
    try:
        opened.setsockopt(socket.SOL_SOCKET, SO_ATTACH_FILTER, program)
    except OSError:
        return False
    return True


def dropped(opened: socket.socket) -> int:
    """Datagrams that the kernel has dropped of a socket: by the filter, or because its buffer was full."""
    numbers = array("I")
    with contextlib.suppress(OSError):
        numbers.frombytes(opened.getsockopt(socket.SOL_SOCKET, SO_MEMINFO, 4 * (DROPS + 1)))
    return numbers[DROPS] if len(numbers) > DROPS else 0

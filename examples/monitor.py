"""A monitor with Python's standard library: it is sent the whole field and prints where everything is.

    python examples/monitor.py [HOST [PORT [FRAMES [KEY]]]]

During a match the referee's key for monitors is needed (page Teams).
"""

import socket
import sys
import time

PING_S = 5.0


def main(host: str = "127.0.0.1", port: str = "6000", frames: str = "100", key: str = "") -> None:
    """Ask for the field and print it."""
    server = host, int(port)
    monitor = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    monitor.settimeout(1.0)
    proof = f" (key {key})" if key else ""
    request, shown, pinged_at = f"(dispinit{proof})", 0, 0.0
    monitor.sendto(request.encode(), server)
    while shown < int(frames):
        try:
            message = monitor.recv(2048).decode()
        except TimeoutError:  # it was lost, or the server was restarted
            monitor.sendto(request.encode(), server)
            continue
        if message.startswith("(challenge"):
            cookie = message.split()[1].rstrip(")")
            monitor.sendto(f"(dispinit{proof} (cookie {cookie}))".encode(), server)
        elif message.startswith("(error"):
            sys.exit(message)
        elif message.startswith("(show"):
            shown += 1
            print(message)
            if time.monotonic() - pinged_at > PING_S:
                pinged_at = time.monotonic()
                monitor.sendto(b"(ping)", server)
    monitor.sendto(b"(bye)", server)


if __name__ == "__main__":
    main(*sys.argv[1:])

"""A client written from the text of the pseudo-local vision paper only. It imports the standard library only.

    python bench/paper_client.py TEAM NUMBER SECONDS HOST PORT

It sends ``(init TEAM NUMBER)``, receives ``see`` messages for some seconds, compares each with the form in the paper
and prints a report as one line of JSON. It uses no code of PSLV: it shows that the paper is enough to write a client.
"""

import itertools
import json
import re
import socket
import sys
import time

SEE = re.compile(
    r"\(see (\d+\.\d+) \(\(edge\) ((?:[!-~][0-9a-f]{2})+)\) \(\(ball\) (-?\d+) (\d+) (\d+)\)\)\0?",
)
PAPER_EDGE_CHARACTERS = 1080


def main(team: str, number: int, seconds: float, host: str, port: int) -> None:
    """Connect, receive for some seconds, print the report."""
    client = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    client.settimeout(1.0)
    client.sendto(f"(init {team} {number})".encode(), (host, port))
    reply, server = client.recvfrom(4096)  # the reply comes from the port that the session uses
    times: list[float] = []
    wrong: list[str] = []
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        try:
            datagram, sender = client.recvfrom(4096)
        except TimeoutError:
            continue
        message = datagram.decode("ascii", "replace")
        found = SEE.fullmatch(message)
        if sender != server or found is None or len(found[2]) != PAPER_EDGE_CHARACTERS:
            wrong.append(message[:80])
            continue
        times.append(float(found[1]))
    client.sendto(b"(bye)", server)
    print(
        json.dumps(
            {
                "team": team,
                "number": number,
                "init": reply.decode(),
                "messages": len(times),
                "per_second": len(times) / seconds,
                "wrong_form": len(wrong),
                "wrong": wrong[:3],
                "increasing": all(earlier < later for earlier, later in itertools.pairwise(times)),
                "times": times,
            }
        )
    )


if __name__ == "__main__":
    team, number, seconds, host, port = sys.argv[1:6]
    main(team, int(number), float(seconds), host, int(port))

"""A robot's client in sixty lines, written from the paper's text, with the standard library alone.

python examples/stdlib_client.py [TEAM NUMBER [HOST [PORT [VIEWS]]]]
"""

import re
import socket
import sys
import time

team, number, host, port, views = [*sys.argv[1:], *["blue", "3", "127.0.0.1", "6000", "100"][len(sys.argv) - 1 :]]

robot = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
robot.settimeout(1)
init = f"(init {team} {number})".encode()
view = re.compile(r"\(see ([0-9.]+) \(\(edge\) (.)([0-9a-f]{2}).*\) \(\(ball\) (-?[0-9]+) ([0-9]+) [0-9]+\).*\)\0?")
passing = "(error not_ready", "(error rate_limited", "(error not_connected"  # the server prepares, is busy, is new
server, seen, silent_s, reported = None, 0, 0, ""
robot.sendto(init, (host, int(port)))
try:
    while seen < int(views):
        try:
            datagram, source = robot.recvfrom(2048)
        except OSError:  # nothing came within a second: datagrams get lost, and servers are restarted, so ask again
            silent_s += 1
            if silent_s == 5 and not server:
                sys.exit(
                    f"nothing answers at {host} port {port}. Does the server run there? Does it listen at an address"
                    " that this computer can reach (its server.udp_host), and admit this computer (admission.subnets)?"
                )
            if silent_s == 5:
                print("no view for 5 s: the camera does not see the robot, or the server is gone", file=sys.stderr)
            robot.sendto(init, server or (host, int(port)))
            continue
        message = datagram.decode("ascii", "replace")
        if message.startswith(passing):
            if message != reported:
                print(f"{message}: asking again every second", file=sys.stderr)
            reported = message
            time.sleep(1)
            robot.sendto(init, (host, int(port)))
        elif message.startswith("(error"):
            sys.exit(message)  # replaced by a newer client, for example: do not init again
        elif message.startswith("(init"):
            server = source  # the port that the server chose; bye goes there too
        elif see := view.fullmatch(message):  # skip what you do not know, as messages of a later version
            server, silent_s, seen = source, 0, seen + 1
            timestamp, letter, px, distance, direction = see.groups()  # straight ahead; direction i begins at 3 * i
            ahead = "nothing" if letter == "-" else f"{letter} at {int(px, 16)} px"
            ball = "hidden" if distance == "-1" else f"{distance} px at {direction} deg"
            print(f"{timestamp} s: ahead {ahead}, ball {ball}")
finally:
    if server:
        robot.sendto(b"(bye)", server)

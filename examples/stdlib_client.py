"""A robot's eyes in fifteen lines, from the paper's text, with the standard library alone.

python examples/stdlib_client.py [TEAM NUMBER [HOST [PORT [VIEWS]]]]
"""

import socket
import sys

team, number, host, port, views = [*sys.argv[1:], *["blue", "3", "127.0.0.1", "6000", "100"][len(sys.argv) - 1 :]]

robot = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
robot.settimeout(5)
robot.sendto(f"(init {team} {number})".encode(), (host, int(port)))
reply, server = robot.recvfrom(2048)  # from the port that the server chose; bye goes there too
if not reply.startswith(b"(init"):
    sys.exit(reply.decode())
for _ in range(int(views)):
    see = robot.recv(2048).decode().replace("(", " ").replace(")", " ").split()
    time, edges, (distance, direction, size) = see[1], see[3], see[5:8]
    letter, px = edges[0], int(edges[1:3], 16)  # straight ahead; direction i begins at 3 * i
    ahead = "nothing" if letter == "-" else f"{letter} at {px} px"
    ball = "hidden" if distance == "-1" else f"{distance} px at {direction} deg"
    print(f"{time} s: ahead {ahead}, ball {ball}")
robot.sendto(b"(bye)", server)

"""A robot's eyes in forty lines, from the paper's text, with the standard library alone.

python examples/stdlib_client.py [TEAM NUMBER [HOST [PORT [VIEWS]]]]
"""

import socket
import sys

team, number, host, port, views = [*sys.argv[1:], *["blue", "3", "127.0.0.1", "6000", "100"][len(sys.argv) - 1 :]]

robot = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
robot.settimeout(1)
for _ in range(5):  # datagrams get lost: repeat the init until it is answered
    try:
        robot.sendto(f"(init {team} {number})".encode(), (host, int(port)))
        reply, server = robot.recvfrom(2048)  # from the port that the server chose; bye goes there too
        break
    except OSError:
        continue
else:
    sys.exit(f"no answer from {host} port {port}: does the server run, and does it admit this computer?")
if reply.startswith(b"(error"):
    sys.exit(reply.decode())

robot.settimeout(5)
seen = 0
try:
    while seen < int(views):
        message = robot.recv(2048).decode()
        if message.startswith("(error"):
            sys.exit(message)  # replaced by a newer client, say: do not init again
        if not message.startswith("(see"):
            continue  # the answer to a repeated init, or something of a later version
        see = message.replace("(", " ").replace(")", " ").split()
        time, edges, (distance, direction, size) = see[1], see[3], see[5:8]
        letter, px = edges[0], int(edges[1:3], 16)  # straight ahead; direction i begins at 3 * i
        ahead = "nothing" if letter == "-" else f"{letter} at {px} px"
        ball = "hidden" if distance == "-1" else f"{distance} px at {direction} deg"
        print(f"{time} s: ahead {ahead}, ball {ball}")
        seen += 1
except TimeoutError:
    sys.exit(f"connected as {team} {number}, but no view for 5 s: the camera does not see the robot")
finally:
    robot.sendto(b"(bye)", server)

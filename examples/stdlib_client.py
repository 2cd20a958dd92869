"""A robot's client in sixty lines, written from the paper's text, with the standard library alone.

python examples/stdlib_client.py [TEAM NUMBER [HOST [PORT [VIEWS]]]]
"""

import socket
import sys
import time

team, number, host, port, views = [*sys.argv[1:], *["blue", "3", "127.0.0.1", "6000", "100"][len(sys.argv) - 1 :]]

robot = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
robot.settimeout(1)
errors_to_wait_for = ("(error not_ready", "(error rate_limited")  # the server still prepares, or is busy
answer, reported, silences = "", "", 0
while not answer.startswith("(init"):
    try:
        robot.sendto(f"(init {team} {number})".encode(), (host, int(port)))
        datagram, server = robot.recvfrom(2048)  # from the port that the server chose; bye goes there too
        answer = datagram.decode()
    except OSError:  # nothing came within a second: datagrams get lost, so repeat the init
        answer, silences = "", silences + 1
        if silences == 5:
            sys.exit(
                f"nothing answers at {host} port {port}. Does the server run there? Does it listen at an address that"
                " this computer can reach (its server.udp_host), and admit this computer (its admission.subnets)?"
            )
    if answer.startswith("(see"):
        break  # the answer was lost, but the session is open
    if answer.startswith(errors_to_wait_for):
        if answer != reported:
            print(f"{answer}: asking again every second", file=sys.stderr)
        reported = answer
        time.sleep(1)
    elif answer.startswith("(error"):
        sys.exit(answer)

robot.settimeout(5)
seen = 0
try:
    while seen < int(views):
        message = robot.recv(2048).decode()
        if message.startswith("(error"):
            sys.exit(message)  # replaced by a newer client, for example: do not init again
        if not message.startswith("(see"):
            continue  # the answer to a repeated init, or a message of a later version
        see = message.replace("(", " ").replace(")", " ").split()
        timestamp, edges, (distance, direction, size) = see[1], see[3], see[5:8]
        letter, px = edges[0], int(edges[1:3], 16)  # straight ahead; direction i begins at 3 * i
        ahead = "nothing" if letter == "-" else f"{letter} at {px} px"
        ball = "hidden" if distance == "-1" else f"{distance} px at {direction} deg"
        print(f"{timestamp} s: ahead {ahead}, ball {ball}")
        seen += 1
except TimeoutError:
    sys.exit(f"connected as {team} {number}, but no view for 5 s: the camera does not see the robot")
finally:
    robot.sendto(b"(bye)", server)

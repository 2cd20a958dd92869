"""``pslv check-client``: a client, by a server that does what a bad evening does.

The server speaks the protocol by the same ``vision_core.protocol`` as the real one, has one client, and shows it a
robot that turns on the spot. One act after the other it answers late, loses, repeats and reorders datagrams, says what
is malformed, changes the mirror, asks whether the client lives, restarts, and gives the robot to somebody else. What it
hears meanwhile says what the client does wrong.

Files: ``examine`` (runs the acts), ``opening``, ``acts``, ``ends`` (the acts), ``hearing`` (what the client has sent),
``server``, ``scenery`` (what it shows), ``weather`` (what happens to datagrams), ``program`` (the client's process).
"""

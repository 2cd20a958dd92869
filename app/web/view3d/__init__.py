"""The 3D view: field, robots, ball and rays in a scene that viser shows in the browser.

viser brings a web server of its own. It listens on the loopback interface, at a port that the system chooses, and turns
away everybody who does not know a secret of this process (``server``); browsers reach it through the page's own port,
login and origin (``relay``). ``scene`` fills it, ``solids`` has its meshes, ``view`` runs it while somebody looks.
"""

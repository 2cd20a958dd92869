"""How true the simulated view is: what PSLV tells a robot, against what the robot's own camera would have shown it.

Theory of operation. A random world is rendered twice at the same instant: by the ceiling camera, whose picture goes
through perception, tracker and views as in the service (``ceiling``), and by the robot's own camera through the mirror
of equation 1, whose picture goes through the on-board image processing module (``onboard``). Both end as the same kind
of report, which is compared direction by direction (``agreement``, ``balls``). The truth of the scene stands between
both. It only scores: every disagreement gets the one cause that it shows (``causes``).

Two things that everybody knows are taken out before comparing: the on-board module corrects the height of the ball's
center, and ``wall_lines`` a white line at a white wall's foot.

Files, outside in: ``experiment``, ``options``, ``resolution``, ``figures``, ``causes``, ``balls``, ``agreement``,
``ceiling``, ``onboard``, ``wall_lines``, ``reports``, ``worlds``.
"""

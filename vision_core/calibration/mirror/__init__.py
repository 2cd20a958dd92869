"""Fits the mirror of equation 1 to pairs of a radius in an on-board picture and a distance on the floor.

*Pairs* (``pairs``) are typed, pasted or read from CSV (``table``). Or they come from pictures: from a click on a target
at a known distance (``target_edge``), or from everything that stands around a robot (``from_views``). ``fit`` puts the
mirror through them, robustly and in pixels, with a prior on the camera's focal length; ``contradictions`` finds pairs
that exclude each other; ``verdict`` judges: how well the curve is known between 0.1 and 2.5 m, which pairs do not
count, and what is missing when it is refused.

A, B and C cannot be told from each other by such pairs alone, the curve can: it is what counts.
Files, outside in: ``verdict``, ``result``, ``contradictions``, ``fit``, ``lines``, ``from_views``, ``target_edge``,
``pairs``, ``rounding``, ``table``, ``draw``. No device is opened here.
"""

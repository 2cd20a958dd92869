"""6. World -> RobotView: what one robot would see from its center, in all directions.

After section 3.3 of the PSLV paper: in each direction the nearest edge on the floor; and the ball, which is
not an edge. Theory of operation, files from the outside in:

``renderer``
    :class:`~vision_core.views.renderer.ViewRenderer`: a world in, the views of all robots out, in one compiled call.
``outlines``
    the outlines of a world's robots and obstacles, computed once for all views.
``splat``
    the nearest edge of every ray: each segment and outline is tested against the rays that can hit it only.
``ball``
    which fraction of the ball is visible, by interval arithmetic on angles.
``rays``
    the rays of a view; where a ray hits a segment.

Rules:

- A view describes the world's instant. Nothing is extrapolated to the instant of sending.
- Robots are circles or squares, as their team's settings say; obstacles are circles. A robot's own outline is not an
  edge of its view. Distances are those on the floor, from the robot's center.
- Robots, obstacles, walls and goals hide what is behind them. A virtual limit (a line, the end of the carpet) is an
  edge of type wall for robots inside of it; it hides nothing, and robots outside do not see it.
- Everything is computed in field space; only the directions of the rays are turned by the heading.
"""

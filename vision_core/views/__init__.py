"""6. World -> RobotView: what one robot would see, from its center, all round.

After section 3.3 of the PSLV paper: in each direction the nearest edge on the floor, and the ball, which is
no edge. Theory of operation, files from the outside in:

``renderer``
    :class:`~vision_core.views.renderer.Eyes`: a world in, what every robot sees out, in one compiled call.
``outlines``
    everything of a world that stands in the way, laid out once for all robots.
``splat``
    the nearest edge of every ray: walls for all rays, then each body for the rays that it can meet.
``ball``
    how much of the ball is visible, by interval arithmetic on angles.
``rays``
    where a ray meets a segment.

Rules:

- A view describes the world's instant. Nothing is extrapolated to the sending.
- Robots are circles or squares, as their team's settings say; obstacles are circles. The own body is no edge.
  Distances are those of the floor, from the own center.
- Robots, walls and goals hide what is behind them. A virtual limit (a line, the end of the carpet) is an edge of type
  wall for who stands inside; it hides nothing, and who stands outside does not see it.
- Everything is computed in field space; only the rays' angles are turned by the heading.
"""

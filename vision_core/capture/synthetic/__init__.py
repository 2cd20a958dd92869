"""The simulated ceiling camera: a known world, rendered to pixels.

Theory of operation. Robots and a ball move in metres on a fixed small time step (``world``, ``physics``),
driven by simple players (``players``); the same seed plays the same match whatever the camera's size and rate.
The camera turns that world into an image the way light does, from the pixel to the scene: every pixel's ray
is known from the camera model (lens distortion and pose included), and the point of the ray at height h
follows from where it meets the floor and from the optical center, as ``camera_model`` explains. So parallax
is not added to the image but comes out of the geometry.

*Background*: all that stands still is sampled 4x4 times per pixel, once (``background``, ``floor``).
*Things that move* are drawn over a copy of it in small windows: robots and legs are upright prisms, the ball
is a sphere. Each of a pixel's 4x4 samples has its own place in the pixel's footprint, which is a little wider
than the pixel as behind any lens, and its own time within the exposure, so that smooth edges, soft focus and
motion blur come from the same sixteen rays (``render``, ``sprites``). Painting from
the outside inwards, seen from the camera, makes nearer things hide those behind them.
*Light* (vignetting, lamps) multiplies all of it; *noise* as a sensor makes it comes last (``noise``).

The instant of an image is the middle of its exposure. Nothing of the world leaves the camera but pixels;
its truth is there for scoring only (``truth``).

Files, outside in: ``camera``, ``world``, ``players``, ``physics``, ``render``, ``sprites``, ``background``,
``floor``, ``noise``, ``truth``.
"""

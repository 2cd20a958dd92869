"""The simulated ceiling camera: a known world, rendered to pixels.

Theory of operation. Robots and a ball move in metres on a fixed small time step (``world``, ``physics``),
driven by simple players (``players``), or by clients' programs (``drivers``); goals, possession and collisions are
counted (``game``). Unless a client drives, the same seed plays the same match whatever the camera's size and rate.
The renderer traces rays from the pixels into the scene. The camera model, with lens distortion and pose, gives
each pixel's ray. A ray is stored as the point where it meets the floor; its point at height h lies the fraction
h / (height of the optical center) of the way from there to the optical center. So parallax is not added to the
image: it follows from the geometry.

*Background*: everything static is rendered once, with 4x4 rays per pixel (``background``, ``floor``).
*Moving bodies* are drawn over a copy of the background, each in a small window: robots and legs are upright prisms,
the ball is a sphere. Each of a pixel's 4x4 rays has its own offset and its own time within the exposure. The offsets
cover an area a little wider than the pixel, as a lens blurs. So the same sixteen rays give antialiasing, soft focus
and motion blur (``render``, ``sprites``). The bodies are painted in the order of their distance from the point below
the camera, the farthest first: nearer bodies cover those behind them (painter's algorithm).
*Light* (vignetting, lamps) multiplies all colors; sensor *noise* is added last (``noise``).

The instant of an image is the middle of its exposure. The camera delivers pixels only; the ground truth is for
scoring (``truth``).

Files, outside in: ``camera``, ``world``, ``players``, ``drivers``, ``game``, ``people``, ``physics``, ``contacts``,
``bodies``, ``render``, ``sprites``, ``background``, ``floor``, ``noise``, ``truth``.
"""

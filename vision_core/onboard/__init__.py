"""The on-board camera, rendered exactly: what a robot's own camera would deliver, to compare the simulated views with.

Theory of operation. A camera looks up at a hyperboloidal mirror whose inner focus lies over the robot's center.
Equation 1 is exactly such a mirror (``mirror_shape``), so the constants A, B, C fix its form. Every pixel's rays are
reflected and followed through the scene, which is the simulated world of ``capture.synthetic`` in three dimensions:
robots and boards are upright prisms, the ball is a sphere (``scene``, ``solids``). The nearest intersection gives the
color (``ray_tracer``). Nothing is approximated but light: it is soft and has no reflections.

The robot's heading points up in the picture, and left is left, as in ``client.panorama``. A picture as it leaves the
camera is its mirror image.

Everything here is off the clock: no task of the service imports it.

Files, outside in: ``camera``, ``truth``, ``scene``, ``solids``, ``ray_tracer``, ``shading``, ``azimuths``,
``prism_rays``, ``mirror_shape``; and for pictures of files ``pictures`` and ``overlay``, which draws what
``client.recognition`` finds in them.
"""

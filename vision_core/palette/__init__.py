"""The palette of a venue: found in pictures without a name for any color, and followed when the light changes.

Theory of operation. A color is evidence, not a box. A paint is a reference color with a spread; what matters is which
palette explains the pictures best. The hot path judges that: with a palette it finds robots, and the picture shows at
their places how clear their markers are.

*Shapes first* (``objects.robots.shape_search``): places where the regions of a marker each have one color and differ.
*Names* (``naming``): which of their colors is which paint, for many scales and shifts of the light.
*Starts* (``starts``): palettes from these names, and from the paints' names alone in many lights.
*Judge* (``trial``): what the hot path reads with a palette, and how much of it the picture confirms.
*Learn* (``learn``): what paints and floor look like, from the robots that are read; then read again.
*Recover* (``recover``): a palette that was right, with the shifts and scales that another light brings.
*Follow* (``follow``): which of these a running service needs, look by look.
*Result* (``result``): samples for the venue's file, papers that are too alike, what was not seen.

Before: FU-Fighters (Egorova et al., "Plug & Play: Fast Automatic Geometry and Color Calibration for Cameras Tracking
Mobile Robots", RoboCup 2004) learned colors from tracked robots; Gunnarsson, Wiesel and Rojas ("The Color and the
Shape", RoboCup 2005) found regions by geometry and learned their colors then.

Files, outside in: ``follow``, ``recover``, ``find``, ``result``, ``starts``, ``learn``, ``trial``, ``light``,
``naming``.
"""

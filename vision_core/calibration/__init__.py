"""Calibrates a camera from the painted lines of the field: lens, distortion and pose, with a verdict.

Theory of operation. The field's measures say where its lines are on the floor; a picture shows where they are in the
image. ``calibrate`` moves a pinhole with distortion until both agree.

*First guess*: a venue's camera that is nearly right, four corners, or none. Without one the picture is searched
(``find``): thin bright ridges (``ridges``), straight lines among them (``straight``), and every way in which four of
them may be four of the field's lines; the hypothesis under which all lines of the field lie nearest to ridges wins.
*Onto the lines* (``align``): shifts, turns and scales as a whole, then rounds of a search across the lines that begins
wide and becomes narrow; first the pose moves alone, then the lens with it.
*Sub-pixel* (``profiles``): the mean brightness across short sections of the lines; both edges of the paint, whose
middle does not depend on blur, glare or the width of the paint. Lines thinner than a pixel count too.
*Solve* (``solver``, ``lens``): Levenberg-Marquardt on the signed distances [px] along the lines' normals, with an
analytic Jacobian, Cauchy's loss, and priors for what one plane seen from above cannot tell: the height of the camera
and its focal length are nearly one parameter, and so are the principal point and the tilt. A tape measure helps.
*Several pictures* (``moved``): each has a pose of its own in the end; a camera that moved between them is refused.
*A lens from a board* (``board``) may hold: the lines then tell the pose alone.
*Verdict* (``judge``): residuals per line, each line's distance from where all others put it, covariance, condition
number, coverage of the field, and the reasons for a refusal.

A field looks the same from both ends, and so it does in a mirror: lines do not tell these apart.
Nothing here guesses.

Files, outside in: ``solve``, ``result``, ``moved``, ``judge``, ``certainty``, ``start``, ``find``, ``straight``,
``align``, ``ridges``, ``profiles``, ``painted``, ``solver``, ``descent``, ``lens``, ``draw``; ``job`` for a process of
its own. The rooms ``board`` (a lens) and ``mirror`` (the robots' mirror) have theories of their own.
No file or device is opened here; a web page may call the same functions.
"""

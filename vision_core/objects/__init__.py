"""Blobs -> sightings: the fourth stage, robots by their markers and the ball.

Theory of operation. Everything is judged in the field's metres, never in pixels: blob centers are
mapped to the plane of what they may be part of (markers at their height, the ball at its radius), and
the camera model says how many pixels such a thing must have there. So one set of gates holds for the
field's center and its corners, and for a camera of any resolution.

*Robots*: hypotheses compete. Every blob that may be a center dot is paired with every dot in reach and
every place of the pattern it might be; each such pair fixes a heading, gathers the dots that then fall
into place, and is fitted rigidly to all of them (``hypotheses``). One score, 0..1, from how many dots
there are, how well they fit and how right their sizes are, decides: best first, a blob serves once, no
two robots stand in one another (``robots``). The same score is the sighting's confidence.

*Ball*: a table of gates, one predicate each (``ball``); a blob that passes all of them is a ball, and
the gates that stopped the others are the reason when none is found.

The compiled path (``robot_finder``) does the same for any marker: a patch in the team's color, the anchor, and
others in slots round it (``markers``). Its score is the share of the marker's painted area that is there * how
well the patches fit * how right their sizes are * how well the anchor's shape agrees with the heading (``shapes``);
an anchor whose other patches are not read is a robot without an id, if it is enough of the marker. Winners' patch
centers are refined, and pose and deviations come from all of them (``poses``). ``robot_reasons`` says in words, for
people, why robots are not seen or not read.

What cannot be told is said, not guessed: a robot without a readable marker has id None, and so have
two robots that wear the same one.

Files, outside in: ``robots``, ``hypotheses``, ``ball``, ``patterns``, ``likeness``; compiled: ``robot_finder``,
``proposals``, ``contest``, ``poses``, ``markers``, ``shapes``, ``finder_memory``; for people: ``robot_reasons``.
"""

"""Blobs -> sightings: the fourth stage, robots by their markers, the ball, and what else stands there.

Theory of operation. Everything is judged in the field's metres, never in pixels: blob centers are
mapped to the plane of what they may be part of (markers at their height, the ball at its radius), and
the camera model says how many pixels such a thing must have there. So one set of gates holds for the
field's center and its corners, and for a camera of any resolution.

*Robots*: hypotheses compete. A marker is a patch in the team's color, the anchor, and other patches in slots round it
(``markers``). Every blob that may be an anchor is paired with every blob in reach and every slot that this might fill;
each such pair fixes a heading, gathers the blobs that then fall into place, and is fitted rigidly to all of them
(``hypothesis_generation``, ``pose_fit``). One score, 0..1, decides: the share of the marker's painted area that is
there * how well the patches fit * how right their sizes are * how well the anchor's shape agrees with the heading
(``shapes``). Best first, a blob serves once, no two robots stand in one another (``conflict_resolution``). An anchor
whose other patches are not read is a robot without an id, if it is enough of the marker. Winners' patch centers are
refined (``circle_fit``), and pose and deviations come from all of them (``pose_refinement``). The score is the
sighting's confidence.

*Ball*: a sequence of gates (``ball.finder``); a blob that passes all of them is a ball, and its center is refined like
a patch's.

*Obstacles*: what differs from the carpet that was learned, and is none of these (``obstacles``). Off the hot path.

What cannot be told is said, not guessed: a robot without a readable marker has id NO_ID, and so have two robots that
wear the same one. ``reasons`` in both folders asks the same kernels, and says in words why nothing is seen
or read.

Folders and files: ``robots/``, ``ball/``, ``circle_fit`` (centers finer than a pixel), ``obstacles``.
"""

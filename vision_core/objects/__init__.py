"""Blobs -> sightings: the fourth stage, robots by their markers, the ball, and obstacles.

Theory of operation. Everything is judged in metres on the field, never in pixels: blob centers are mapped to the plane
of the object that they may belong to (markers at their height, the ball at its radius), and the camera model says how
many pixels such an object has there. So one set of gates is right in the field's center and in its corners, and for a
camera of any resolution.

*Robots*: hypotheses compete. A marker is a patch in the team's color, the anchor, and other patches in slots round it
(``markers``). Every blob that may be an anchor is paired with every blob in reach and every slot that this blob may
fill. Each pair fixes a heading and gathers the blobs that then lie in the other slots; a rigid pose is fitted to all of
them (``hypothesis_generation``, ``pose_fit``). The score, 0..1, is the coverage of the marker's painted area * how well
the patches fit * how right their areas are * how well the anchor's shape agrees with the heading (``shapes``). The best
hypotheses are selected such that a blob belongs to one robot at most and no two robots overlap
(``conflict_resolution``). An anchor whose other patches are not recognized is a robot without an id, if it is enough of
the marker. The patch centers of selected robots are refined (``circle_fit``), and pose and deviations follow from all
of them (``pose_refinement``). The score is the sighting's confidence.

*Ball*: a sequence of gates (``ball.finder``); a blob that passes all of them is a ball, and its center is refined like
that of a patch.

*Obstacles*: what differs from the learned carpet and is none of these (``obstacles``). Off the hot path.

What is not known is reported as unknown, never guessed: a robot without a readable marker has id NO_ID, and so have two
robots with the same marker. ``reasons`` in both folders calls the same kernels and explains in sentences why an object
is not found or a robot has no id; ``verdicts`` say it of each blob.

Folders and files: ``robots/``, ``ball/``, ``observation`` (what both get of a frame), ``field_limits`` (where both are
accepted), ``circle_fit`` (centers finer than a pixel), ``obstacles``.
"""

"""Robots by their markers.

``finder`` (one compiled call) over ``hypothesis_generation`` (ways to see a robot at each blob of its team's color),
``pose_fit`` (the blobs and the pose of one of them), ``conflict_resolution`` (the best that do not overlap) and
``pose_refinement`` (sub-pixel), then ``marker_reading`` (ids that the blobs do not tell) with the ``references`` of
paints; ``markers`` (a pattern as the finder needs it), ``shapes`` (a patch's outline), ``buffers`` (memory allocated
once). For people: ``reasons`` (why a robot is not found or has no id) over ``unread`` and ``headless`` (what is like a
robot), ``alternatives`` and ``marker_size`` (what would explain all of it); ``verdicts`` (what becomes of each blob);
both over ``scene`` (what can be asked of a frame). ``pattern_warnings`` for a venue without a picture.
"""

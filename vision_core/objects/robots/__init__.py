"""Robots by their markers.

``finder`` (one compiled call) over ``hypothesis_generation`` (ways to see a robot at each blob of its team's color),
``pose_fit`` (the blobs and the pose of one of them), ``conflict_resolution`` (the best that do not overlap) and
``pose_refinement`` (sub-pixel) with ``shape_reading`` (ids told by the shape of a patch), then ``marker_reading`` (ids
that the blobs do not tell); where a team has several markers, ``marker_weighing`` asks which explains the pixels.
Robots without blobs: ``held`` (those of the last frames, where they should be) and ``shape_search`` (slow: places in
the whole picture) say where ``confirmation`` looks for them, by the marker's shape (``marker_shape`` over ``template``)
and its paints with white mixed in (``paint_residual``).
``markers`` (a pattern as the finder needs it) with its ``code_shapes`` and ``body_points``, ``shapes`` (a patch's
outline), ``buffers`` (memory allocated once). For people: ``reasons`` (why a robot is not found or has no id) over
``unread`` and ``headless`` (what is like a robot), ``alternatives`` and ``marker_size`` (what would explain all of it);
``verdicts`` (what becomes of each blob); both over ``scene`` (what can be asked of a frame). ``pattern_warnings`` for a
venue without a picture.
"""

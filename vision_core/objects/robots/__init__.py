"""Robots by their markers.

``finder`` (one compiled call) over ``hypothesis_generation`` (ways to see a robot at a blob), ``pose_fit`` (which
blobs, which pose), ``conflict_resolution`` (best first, none overlap) and ``pose_refinement`` (sub-pixel);
``markers`` (a pattern as the finder needs it), ``shapes`` (patches by outline), ``buffers`` (memory taken once),
``reasons`` (why a robot is not seen or not read).
"""

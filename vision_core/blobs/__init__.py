"""Classes -> blobs: the third stage, one pass over the picture.

Theory of operation. Every row is cut into runs of equal class, as it is read. A run that touches a
run of the same class in the row above (diagonally counts) joins its region: a union-find forest over
the runs, whose roots are always the earliest run of their region, so that a second pass over the few
runs - not over the pixels - sums area, centroid and bounding box. This is the classic of robot soccer
(Bruce, Balch and Veloso, "Fast and inexpensive color image segmentation for interactive robots",
IROS 2000; CMVision), and the reference that faster ways must agree with.

Memory is taken once. When a picture has more runs or blobs than there is room for, the rest is left
out and the result says so (``complete``): a lamp that floods the picture must not stall the clock.

Files: ``run_lengths``; apart from it ``growing`` and ``growing_tracker``, which look for one object from where it was.
"""

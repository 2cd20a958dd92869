"""Classes -> blobs: the third stage, a look at some rows of the picture, or one pass over all of it.

Theory of operation: the classic. Every row is cut into runs of equal class, as it is read. A run that touches a
run of the same class in the row above (diagonally counts) joins its region: a union-find forest over
the runs, whose roots are always the earliest run of their region, so that a second pass over the few
runs - not over the pixels - sums area, centroid and bounding box. This is the classic of robot soccer
(Bruce, Balch and Veloso, "Fast and inexpensive color image segmentation for interactive robots",
IROS 2000; CMVision), and the reference that faster ways must agree with.

Rows and flood fill. What is searched covers about a hundredth of the picture, so most of it need not be read. A blob
is connected, so it has a pixel in every row between its top and its bottom: one that is at least d rows high cannot
hide from rows d apart. Each row looked at is judged 64 pixels at a time: a test of saturating byte arithmetic that
was made from the color table (``Candidates``; no color with a class fails it) leaves most of the floor out, then the
table decides. Where a run with a class starts, a flood fill by runs collects the whole blob, in whatever rows it lies;
a bit per pixel keeps it from being found twice. d comes from the smallest dot that is searched
(``rows.least_height_px``); lower blobs are found by luck.

Windows round predictions cut the rows looked at further; beside them a scan band of rows moves over the picture from
frame to frame, so that what appears anywhere is found within one round of it. When more would be flooded than
``max_flood_fraction`` allows (the table has the colors of the floor), the classic takes over for that picture: the same
blobs in class, area, center and box, but in scan order and with all low ones among them.

Memory is taken once. When a picture has more runs or blobs than there is room for, the rest is left
out and the result says so (``complete``): a lamp that floods the picture must not stall the clock.

Files: ``rows`` over ``flood`` and ``lanes`` (instructions on 64 pixels); ``run_lengths`` (the classic); apart from
them ``growing`` and ``growing_tracker``, which look for one object from where it was.
"""

"""Classes -> blobs: the third stage. Reads some rows of the picture, or all of it.

Theory of operation. There are two segmentations, which find the same blobs.

*Reference* (``run_lengths``). Every row is cut into runs of equal class while it is read. A run that touches a run of
the same class in the row above, diagonally too, joins its region: a union-find forest over the runs, whose roots are
always the earliest run of their region. So a second pass over the few runs, not over the pixels, sums up area, centroid
and bounding box. (Bruce, Balch and Veloso, "Fast and inexpensive color image segmentation for interactive robots",
IROS 2000; CMVision.)

*Row scan* (``row_scan``). Blobs cover about a hundredth of the picture, so most of it need not be read. A blob is
connected, so it has a pixel in every row between its top and its bottom: one that is at least d rows high cannot lie
between rows that are d apart. Of every d-th row 64 pixels are judged at once: a test in saturating byte arithmetic,
made from the color table (``ColorPrefilter``; every color with a class passes it), leaves out most of the floor, then
the table decides. Where a run with a class starts, a flood fill by runs collects the whole blob (``flood``); a bit per
pixel keeps it from being found twice. d follows from the smallest dot that is searched (``row_scan.min_height_px``);
lower blobs are found by chance.

Windows round predicted positions reduce the sampled pixels further. Beside them a scan band of rows moves over the
picture from frame to frame, so that anything new is found within one round of it. When more would be flooded than
``max_flood_fraction`` allows (the table has the colors of the floor), the reference takes over for that picture: the
same blobs in class, area, center and box, but in scan order and with all low ones among them.

Masked pixels, in which nothing is looked for, are background to both: the row scan takes them for visited. Without
masks the kernels are compiled without a test for them.

Memory is allocated once. When a picture has more runs or blobs than there is room for, the rest is left out and the
result says so: a lamp that floods the picture must not delay the next frame.

Files: ``row_scan`` over ``flood`` and ``simd`` (instructions on 64 pixels at once); ``run_lengths``; ``bits``
(a bit per pixel).
"""

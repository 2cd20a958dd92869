"""Colors -> classes: the second stage, computed before the first frame.

Theory of operation. The operator describes a color class by ranges in a color space that separates light from color
(HSV, CAMBADA's YMP or B-Human's ECImage: ``spaces``), or by measured colors (``samples``). A camera delivers 24 bits
per pixel. Quantized to 16 bits (5 blue, 6 green, 5 red) there are only 65536 different colors; each of them is judged
once, by the center of its cell, and the results become one table (``lookup_table``). A pixel's class then costs one
shift-and-or and one read, whatever the space and however many the ranges (Bruce, Balch and Veloso, "Fast and
inexpensive color image segmentation for interactive robots", IROS 2000).

The table is made for the light of the venue. When the light changes, the pictures are converted back to it by one gain
per channel (``light``): the table stays, and the later stages see no difference.

From the table a test is made that 64 pixels pass or fail at once (``prefilter``), so that most of the floor need not be
looked up.

Files, outside in: ``light``, ``prefilter``, ``lookup_table``, ``samples``, ``spaces``; for people: ``explain``,
``pictures``.
"""

"""Colors -> classes: the second stage, worked out before the first frame.

Theory of operation. The operator describes a color class by boxes in a space in which light and
color are apart: HSV, CAMBADA's YMP or B-Human's ECImage (``spaces``), or by colors that he measured
(``samples``). A camera delivers 24 bits per pixel; quantized to 16 bits
(5 blue, 6 green, 5 red) there are only 65536 different colors, so every one of them is judged once,
by the center of its cell, and the verdicts become one table (``lookup_table``). Per pixel there is
then one shift-and-or and one read, whatever the space and however many the boxes (Bruce, Balch and
Veloso, "Fast and inexpensive color image segmentation for interactive robots", IROS 2000).

The table is made for the venue's light. When the light changes the pictures are taken back to it, by
one gain per channel (``light``): no table need be made again and nothing behind it knows.

From the table a test is made that 64 pixels pass or fail at once (``candidates``): most of the floor need not be
looked up at all.

Files, outside in: ``light``, ``candidates``, ``lookup_table``, ``samples``, ``spaces``; for people: ``explain``,
``pictures``.
"""

"""The lens from pictures of a printed ChArUco board, as an alternative to painted lines; the lines then tell the pose.

A board is flat and its corners are known, so pictures of it from several sides tell focal length, center and distortion
without any height. Its size does not matter: a lens looks the same for a board twice as large and twice as far away.

Files, outside in: ``lens`` (from pictures to a lens and a verdict), ``result``, ``judge``, ``solve``, ``corners``,
``sheet`` (pages to print), ``board``.
"""

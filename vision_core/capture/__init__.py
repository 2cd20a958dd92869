"""Light -> images: the first stage.

Theory of operation. A source is anything that fills a buffer with the next image and tells when that
image was grabbed. It blocks until the image is there, so that the task round it is one loop, and it never
hands out an image twice: what is gone raises SourceError, and the task opens the source anew.

The grab instant is the one time that counts later. A camera's is the driver's own stamp of the buffer
where there is one. Sources without a driver (files, the simulated camera) lie on an absolute grid, kept
by one rate keeper (``pace``): late means that whole periods are left out, never that frames hurry.

Files, outside in: ``source`` (the protocol, and which source an address means), ``playback`` (pictures and
videos), ``camera`` (V4L2), ``synthetic`` (a rendered world), ``pace``.
"""

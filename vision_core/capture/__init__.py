"""Light -> images: the first stage.

Theory of operation. An image source writes the next image into a buffer and returns when it was grabbed. It waits until
the image has come, so the task that uses it is one loop, and it never delivers an image twice. When the device or file
is lost it raises SourceError, and the task opens the source again.

All later times refer to the instant of the grab. A camera's is the driver's time stamp of the buffer, if there is one.
Sources without a driver (files, the simulated camera) deliver on an absolute grid of instants, made by
``timing.rate_keeper``: a late source skips whole periods, and frames never follow each other faster.

Files, outside in: ``source`` (the interface, and the choice by address), ``playback`` (pictures and videos), ``camera``
(V4L2), ``devices`` (by name or serial number), ``synthetic`` (a rendered world).
"""

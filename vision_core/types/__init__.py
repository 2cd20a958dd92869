"""What flows: passive data, one module per step of the flow.

    light -> ImageFrame (image) -> color classes (colors) -> blobs -> Sightings (objects)
          -> World (tracks) -> RobotView (views) -> datagram

From the blobs on, the hot path holds all of it in ``tables``: arrays of rows, allocated once and filled in place. The
records of the other modules are the same for people, frozen, without code beyond trivial derived values. ``prefilter``
is a fast test made from a color table, ``color_cells`` finds a pixel's cell in kernels; ``reasons`` says what is wrong
and what to do; ``field`` holds what does not
flow: what stands on the field, and what an edge can be.
"""

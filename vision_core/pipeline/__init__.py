"""Several stages in one compiled call: what tasks, commands and benchmarks share.

``perception`` (pixels -> sightings), ``view_encoder`` over ``see_kernels`` (world -> datagrams), ``diagnosis`` (why
nothing is seen, in words), ``warm_up`` (every kernel used once).
"""

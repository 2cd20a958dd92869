"""Several stages in one compiled call: shared by tasks, commands and benchmarks.

``perception`` (pixels -> sightings), ``view_encoder`` over ``see_kernels`` (world -> datagrams), ``diagnosis`` (why
robots or ball are not seen, in words), ``overlay`` (what is drawn over the picture for people), ``warm_up`` (uses every
kernel once, so that it is compiled).
"""

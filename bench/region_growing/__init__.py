"""Region growing from an object's last position, as the CAMBADA robots had it, for the experiments with it.

``region`` grows one region (kernels), ``tracker`` follows one object from picture to picture with it. The service
segments whole pictures instead; ``bench.growing`` compares the two, ``bench.cambada`` repeats the paper's experiment.
"""

"""Region growing from an object's last position, the method of the CAMBADA robots, for experiments.

``region`` grows one region (kernels); ``tracker`` uses it to track one object from picture to picture. The service
segments whole pictures instead. ``bench.growing`` compares the two; ``bench.cambada`` repeats the paper's experiment.
"""

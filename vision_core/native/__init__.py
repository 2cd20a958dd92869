"""The doors to compiled libraries: numba's kernels and where they are cached, OpenCV. Nobody else imports either."""

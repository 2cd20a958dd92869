"""The doors to compiled libraries: numba's kernels with their files on disk, and OpenCV.

``kernels`` (``@kernel`` compiles a function), ``kernel_cache`` (numba's cache, replaced by ours), ``kernel_folder``
(where the files lie), ``fingerprint`` (which code they belong to), ``private_folder`` (a folder that no other user can
write into), ``opencv``.
"""

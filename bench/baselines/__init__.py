"""C twins: small programs of our own, compiled by a benchmark when there is a compiler, to measure against.

The product itself needs no compiler; C lives in ``bench`` only. File: ``build``.
"""

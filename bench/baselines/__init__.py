"""Baselines: small C programs of our own, which a benchmark compiles and measures in the same run as the product.

Each says in its head comment which part of the product it repeats. The product itself needs no compiler; C lives in
``bench`` only. ``build`` compiles and loads them.
"""

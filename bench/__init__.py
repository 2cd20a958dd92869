"""The benchmarks behind every published figure. ``python -m bench`` runs all, ``python -m bench NAME`` one.

``accuracy`` scores the pipeline against the truth of the synthetic camera; ``clients`` runs the whole
service with ten clients written from the paper's text; ``recovery`` kills its processes one by one.
"""

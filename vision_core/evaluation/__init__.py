"""How good recognition is on pictures from files: the offline side of the pipeline, behind commands of ``pslv``.

``stills`` (pictures -> sightings), ``overlay`` (what was seen, drawn), ``score`` over ``truth_files`` and
``assignment`` (recall and precision), ``pattern_colors`` (whether a venue tells a pattern's colors apart).
"""

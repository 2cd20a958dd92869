"""Quality of recognition on pictures from files: the work of ``pslv detect``, ``evaluate`` and ``patterns check``.

``stills`` (pictures -> sightings), ``overlay`` (sightings drawn into pictures), ``score`` over ``truth_files`` and
``assignment`` (recall and precision), ``lights`` (the same in other light), ``pattern_colors`` (whether a venue's
classes separate a pattern's colors), ``surroundings`` (what stands around a robot, for its own camera's mirror).
"""

"""The field as the picture shows it, compared with the venue's settings. Off the hot path.

``exposure`` judges whether the field is lit well enough, ``lines`` whether the painted lines are where the field's
measures and the camera put them, ``boundary`` finds where the carpet ends. Each samples a fixed number of points of the
field, so a larger picture takes no longer, and returns numbers (``vision_core.types.regions``); the first two also say
in sentences what is wrong.
"""

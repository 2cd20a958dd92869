"""What part of an image matters, and whether it can be used at all. Off the hot path.

``exposure`` judges how light the field is, ``lines`` whether the painted lines are where the field's measures and the
camera say, ``boundary`` finds where the carpet ends. Each looks at points of the field alone, so a larger picture takes
no longer, and tells numbers (``vision_core.types.regions``); the first two say in words, too, what is wrong.
"""

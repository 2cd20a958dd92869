"""What part of an image matters, and whether it can be used at all. Off the hot path.

``exposure`` judges how light the field is, ``lines`` whether the painted lines are where the field's measures and the
camera say.
"""

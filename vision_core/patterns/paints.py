"""The paints that markers and balls are drawn and printed with."""

PAINTS_BGR = {
    "blue": (200, 90, 20),
    "yellow": (40, 210, 235),
    "green": (90, 225, 60),
    "pink": (190, 70, 235),
    "orange": (30, 120, 250),
    "red": (40, 40, 220),
    "cyan": (220, 210, 40),
    "purple": (170, 50, 120),
    "magenta": (225, 45, 225),
    "pale": (200, 215, 215),
    "white": (235, 235, 235),
}
"""Paints by the name of a color class: blue, green, red."""

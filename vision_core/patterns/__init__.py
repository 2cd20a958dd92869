"""Markers: what a pattern file says, and what can be told about it without a picture.

``geometry`` (patches as polygons and disks), ``loader`` (a pattern file, checked), ``distinctness`` (which ids can be
mistaken for one another), ``paints`` (colors for drawing and printing), ``sheets`` (pages to print).
"""

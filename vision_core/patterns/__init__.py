"""Markers: pattern files, and what follows from them without a picture.

``geometry`` (patches as polygons and disks), ``pattern`` (a marker as its file describes it), ``loader`` (reads the
file), ``checks`` (is it read in one way only?), ``worn`` (what the robots of a team wear), ``distinctness`` (which ids
can be confused), ``paints`` (colors for drawing and printing),
``match_rules`` (ids for all robots of a match), ``sheets`` (pages to print).
"""

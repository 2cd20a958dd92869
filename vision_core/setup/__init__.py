"""Sets up a new venue from pictures of it: each step is a function, for the page, the command and REST alike.

Theory of operation. A ``Draft`` is everything that is known so far; each step looks at the pictures and returns a
finding, which changes nothing until somebody takes it into the draft. ``venue_file`` writes a draft as a venue's file,
with the reason of every value as a comment; the settings of a draft are those that this file gives, so what was tried
is what is saved. ``folder`` keeps a draft with its pictures, its history and its findings on the disk.

The steps: ``recognize`` (which field preset, by its painted lines), ``camera`` (by the lines, or by the corners of
walls), ``colors`` (found, or sampled; the class of every pixel), ``trial`` (what is seen with it, picture by picture).

Files, outside in: ``run`` (the steps, for a process of their own) with ``jobs`` and ``findings``, which are data
alone, ``trial``, ``colors``, ``floor_colors``, ``recognize``, ``camera``, ``folder``, ``venue_file``, ``choices``,
``draft``. A page imports the data, ``folder``, ``venue_file`` and ``choices``: no stage of perception is loaded by it.
"""

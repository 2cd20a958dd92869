"""The impartiality report: whether both teams of a match were served alike, and how that was judged.

``statistics`` turns the record of fairness (``vision_core.types.fairness``) into tests, ``verdict`` puts them into
words, ``app.web.reports.fairness`` is the whole as the API has it, ``picture`` and ``page`` show it, ``kept`` keeps it
on disk. The report tells no positions: everybody may read it, also during a match.
"""

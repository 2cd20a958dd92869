"""The real-time database: shared memory that says how old it is (CAMBADA paper, section 2).

Theory of operation. One block of anonymous shared memory (``memfd_create``) holds every record. The
supervisor makes it and hands its descriptor down; it vanishes with the last process that maps it, so
nothing is left behind whatever dies. Each record has **one writer**, any number of readers and no lock
that a dead process could hold: a ring of slots, of which the writer fills the one after the newest
between two sequence numbers and then moves the head. A reader copies the head's slot and looks at the
sequence again; with four slots it is overtaken only if it sleeps for three whole writes.

Rules: every read says value, age and validity; there is no read without an age. A record's payload is
bytes; ``records`` says what they mean.

Files, outside-in: ``records`` (names, types and codecs of all records), ``store`` (the block), ``slots``
(one record's ring), ``layout`` (where everything lies).
"""

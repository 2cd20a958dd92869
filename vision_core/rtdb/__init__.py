"""The real-time database: shared memory whose every value has an age (CAMBADA paper, section 2).

Theory of operation. One block of anonymous shared memory (``memfd_create``) holds every record. The
supervisor makes it, and its children inherit the descriptor; it vanishes with the last process that maps
it, so nothing is left behind when a process is killed. Each record has **one writer**, any number of
readers, and no lock that a dead process could hold: it is a ring of slots. The writer fills the slot after
the newest one, between two sequence numbers, and then moves the head. A reader copies the head's slot and
reads the sequence number again; with four slots the writer overtakes a reader only after three more writes.

Rules: every read returns value, age and validity. A record's payload is bytes; ``records`` defines their
meaning.

Files, outside-in: ``records`` (names, types and codecs of all records, and the catalog of those that can be
shown), ``catalog`` (reads the catalog at one instant), ``infos`` (values of the records about the service),
``task`` (one line of the task table), ``process_state``, ``items`` (typed records), ``store`` (the block),
``slots`` (one record's ring), ``layout`` (where every record lies in the block).
"""

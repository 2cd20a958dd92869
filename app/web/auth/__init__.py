"""Who asks, and what they may: the lock on the door of the web process.

``identity`` (roles, and who sent a request), ``credential`` (with what he came, and whether it is still good),
``rules`` (what a request needs), ``people`` (passwords, sessions, tokens, first-run tokens), ``team_keys``, ``audit``
(what was done by whom), ``attempts`` (how often one may try to log in), ``hashing`` (secrets are kept as hashes only),
``people_file`` (the file of them all, ``people.db``).
"""

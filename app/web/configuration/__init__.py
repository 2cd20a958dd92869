"""Changes from the page: checked like the user's files, kept in the document, applied while the service runs.

A change never writes into the user's files. It is an overlay: one more layer of settings above the venue's file, made
from the document's entries (``overlay``). ``configuration`` is the one door through which everything is changed: it
builds the settings that would follow, lets the loader of the files judge them, keeps the change with who, when, before
and after, and publishes what can be applied at a frame boundary as the record ``live_settings``. ``catalog`` lists all
settings with the words of ``config/default.toml``. ``teams`` holds what a team is.
"""

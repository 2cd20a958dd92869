"""What the service remembers between two starts, in SQLite files of the data folder.

``database`` opens a file, sets a damaged one aside and keeps a good copy. ``document`` holds what was changed on the
page, with its history, undo and redo.
"""

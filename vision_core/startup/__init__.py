"""The main modules of the service's processes, before a task runs.

``preflight`` (can the tasks work with these settings?), ``compile`` (every kernel, once), ``process`` (the tasks of the
table that name it), ``spare`` (has loaded everything and waits to take the place of a process).
"""

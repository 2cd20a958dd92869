"""From the command line to a running service.

Files, outside-in: ``service`` (from the first start to the end, restarts among it), ``prepared`` (the settings),
``kept_changes`` (what the page changed before), ``first_lines`` (what a start prints), ``preflight`` (can it work?),
``restart_check`` (would it start again?), ``plan`` (what the supervisor starts), ``sockets``, ``page`` (built beside
the kernels), ``resource_owners`` (which process has a port or a camera open).
"""

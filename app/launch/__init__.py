"""From settings to a running service: ``preflight`` (can it work?), ``plan`` (what the supervisor starts),
``resource_owners`` (which process has a port or a camera open)."""

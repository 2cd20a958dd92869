"""From settings to what the supervisor starts: ``plan``, and ``resource_owners`` (who holds a port or a camera)."""

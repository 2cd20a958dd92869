"""What stands in front of every route: one file per rule."""

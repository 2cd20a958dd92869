"""Groups of commands that are more than a line; ``app.cli`` registers them."""

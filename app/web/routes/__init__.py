"""The routes, one file per subject; each gets what it needs as an argument."""

"""Rules for every request, one module each."""

"""Settings: ``schema`` declares every key once, with its type and range."""

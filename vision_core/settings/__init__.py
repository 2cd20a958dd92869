"""What can be set: ``schema`` declares every key once, with its type and range."""

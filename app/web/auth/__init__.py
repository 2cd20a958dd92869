"""Who asks: identities of requests, and the keys of teams."""

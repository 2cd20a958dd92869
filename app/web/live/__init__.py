"""The page's WebSocket: ``connection`` (who is open, newest wins) and ``messages`` (what is sent)."""

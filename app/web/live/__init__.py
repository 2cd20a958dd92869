"""The page's WebSocket: ``connection`` serves open pages, ``messages`` makes what they are sent."""

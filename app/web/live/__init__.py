"""The page's WebSocket: ``connection`` serves open pages, ``messages`` makes what they are sent, ``topics`` fills it.

``overlays`` has the task ``overlay`` draw while somebody looks; ``delay`` holds back what viewers see of a match.
docs/live.md describes every topic.
"""

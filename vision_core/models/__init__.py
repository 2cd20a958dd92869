"""What a venue is, as geometry: camera, mirror and field, and how they are made from settings."""

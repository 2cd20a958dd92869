"""The on-board camera: geometry against equation 1, pictures against places."""

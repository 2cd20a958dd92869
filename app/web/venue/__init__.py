"""Setting up a new venue on the page: ``desk`` has the one draft and its jobs, ``use`` makes a venue the settings."""

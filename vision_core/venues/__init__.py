"""Settings files: from TOML layers to checked settings.

``loader`` reads default.toml, a field, a venue and the environment, in this order. ``rules`` and ``camera_rules`` check
what depends on several keys; ``violation`` is what they report. ``toml_lines`` finds the line of a key, for messages;
``palette_edit`` writes color samples into a file.
"""

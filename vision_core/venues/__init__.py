"""Settings files: from TOML layers to checked settings.

``loader`` reads default.toml, a field, a venue and the environment, in this order; ``rules`` checks what no single key
shows; ``toml_lines`` finds the line of a key, for messages.
"""

"""What the API reports: one module per subject, which holds the model and the function that fills it from a snapshot.

``status`` puts ``source``, ``camera`` (with its ``checks``), ``clients``, ``machine`` and ``processes`` together.
``tasks``, ``timing`` and ``field`` have endpoints of their own. Docstrings of models and fields become the text of the
OpenAPI document.
"""

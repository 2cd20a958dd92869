"""The benchmarks behind every published figure. ``python -m bench`` runs all, ``python -m bench NAME`` one.

What is seen: ``accuracy`` scores the pipeline against the truth of the synthetic camera. What it costs:
``segmentation``, ``loop``, ``views``, ``fanout`` and ``growing``, against programs of our own in C where there is a
compiler (``twins``).

The real-time core: ``torn`` tries to read what is half written; ``scheduling`` repeats the CAMBADA paper's experiment;
``activation`` holds tasks of the running service against a C program's; ``handover`` measures from a frame to its last
datagram; ``dashboards`` whether pages delay it; ``pauses`` whether Python does. The whole service: ``clients`` runs it
with ten clients written from the paper's text; ``faults`` kills and stops its processes one by one.

What stands beside a measurement as a process of its own: ``companions`` starts it; ``receiver`` is all clients,
``pages`` all pages, ``stamps`` and ``freshness`` look into the database, ``sleeper`` shows when the machine stood
still.
"""

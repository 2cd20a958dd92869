"""The benchmarks behind every published figure. ``python -m bench --help`` lists them, one line each.

A benchmark is a module with ``run()`` that returns rows for the table (``runner``): a value, its unit, the value of a
baseline measured in the same run, their ratio, and the goal. Baselines in C are compiled where there is a compiler
(``baselines``); without one their rows are left out.

Accuracy against the ground truth of the simulated camera: ``accuracy`` of the pipeline, ``calibration`` of the camera.

Cost of the pipeline's stages: ``segmentation``, ``loop`` (all stages), ``views``, ``udp_send``, ``growing``.

Impartiality: ``fairness``, and ``send_stamps`` (what its stamps cost).

Real-time behavior: ``torn_reads`` (the database), ``scheduling`` (the CAMBADA paper's experiment, with ``cambada``),
``activation``, ``handover`` (with rehearsals and without), ``no_trace`` (of rehearsals), ``dashboards``, ``gc_pauses``.

Clocks: ``clock_sync`` (with ``clock_paths``).

The whole service: ``first_start``, ``clients``, ``light`` (with ``true_world``), ``faults`` (with ``fault_targets`` and
``shutdown``).

Shared parts: ``calibration_views`` renders the pictures of random cameras, ``service`` starts the real service,
``pictures`` gives it a fast camera, ``load`` keeps all cores busy. Helper processes run beside a measurement
(``helpers``): ``receiver`` is all clients, ``pages`` all web pages, ``record_timestamps`` and ``freshness`` read the
database, ``stall_detector`` shows when the machine stood still.
"""

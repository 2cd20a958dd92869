"""The real-time core: from a ceiling camera's light to every robot's datagram. It knows no web.

    light -> ImageFrame -> color classes -> blobs -> Sightings -> World -> RobotView -> datagram

Top to bottom; who stands lower imports nobody above (held by the contracts in pyproject.toml):

    startup/      main modules of processes: preflight, compile, process, spare
    setup/        a new venue from pictures, step by step
    fidelity/     how true the views are: against the on-board picture of the same world
    onboard/      what a robot's own camera would show, ray by ray
    examination/  for teams: a server, a client and the way between them, against docs/protocol.md; numpy alone
    evaluation/   how good recognition is on files: stills, overlay, score
    client/       for teams: connect, views, panorama, camera, recognition; numpy alone
    tasks/        table.py is read first, then one file per task
    palette/      the colors of a venue: found in pictures, and followed when the light changes
    pipeline/     several stages in one compiled call
    net/          the only server sockets
    calibration/  a camera from the painted lines in pictures
    scheduling/   runs tasks at their periods and priorities, and measures them
    protocol/     datagram bytes, without sockets
    rtdb/         the real-time database in shared memory
    capture/ color/ blobs/ objects/ regions/ tracks/ views/
                  the stages; they never import one another
    patterns/     markers
    venues/       settings files
    models/       camera, mirror, field
    settings/     what can be set
    types/        what flows
    native/       numba, OpenCV
    timing/       rates, histograms
    geometry arrival_stamps user_files clock errors
"""

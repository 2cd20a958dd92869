"""The detectors of CAMBADA's vision for one ceiling camera: as tasks of the service, and as one loop.

The paper is P. Pedreiras et al., "Enhancing the reactivity of the vision subsystem in autonomous mobile robots using
real-time techniques". Its robots had two cameras and ten detectors. This camera hangs over the field, and its images
have 640x480 pixels where the paper's had 320x240, so each task detects what comes nearest to the paper's:

    avoid_om  obstacles: everything that stands on the carpet, robots included   every frame
    avoid_fr  the field's boundary                                               every frame
    ball_om   the ball, by region growing from its last position                 every frame
    ball_fr   robots and ball in the whole picture, by color segmentation        every frame
    kgoal     the goal line of blue's keeper                                     every 2nd
    bgoal     the goal that blue defends, by region growing in its color         every 4th
    ygoal     yellow's goal                                                      every 4th
    line      all painted lines                                                  every 8th
    bpost     the field's corners at blue's end                                  every 16th
    ypost     the field's corners at yellow's end                                every 16th

``paper`` has the paper's tables. ``image_sequence`` renders the frames that both architectures process. ``detectors``
has one class for each kind of object, with ``profiles`` for lines and edges. ``tasks`` makes each detector a task of
the service, and ``venue`` is the venue that declares these tasks. ``monolith`` is one loop that runs all detectors on
every frame. ``activation_log`` records when tasks and loop ran, ``results`` and ``picture`` make tables and figures of
it. ``bench.scheduling`` runs the experiment.
"""

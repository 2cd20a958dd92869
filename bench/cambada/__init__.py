"""The detectors of CAMBADA's vision, remade for one ceiling camera: as tasks of the service, and as one loop.

The paper is P. Pedreiras et al., "Enhancing the reactivity of the vision subsystem in autonomous mobile robots using
real-time techniques". Its robots had two cameras and ten things to look for; this camera hangs over the field, and its
images have 640x480 pixels where theirs had 320x240. So a task looks for what comes nearest to theirs:

    avoid_om  obstacles: whatever stands on the carpet, robots included        every frame
    avoid_fr  the field's boundary                                             every frame
    ball_om   the ball, by region growing from where it was                    every frame
    ball_fr   robots and ball of the whole picture, by color segmentation      every frame
    kgoal     the goal line that blue's keeper stands on                       every 2nd
    bgoal     the goal that blue defends, by region growing in its color       every 4th
    ygoal     yellow's goal                                                    every 4th
    line      all painted lines                                                every 8th
    bpost     the field's corners at blue's end                                every 16th
    ypost     the field's corners at yellow's end                              every 16th

``paper`` has the paper's tables; ``test_sequence`` renders the frames that both see; ``detectors`` looks at them with
the help of ``profiles``; ``tasks`` makes each detector a task of the service, ``venue`` the venue that declares them;
``monolith`` is the loop that does everything for every frame, one after the other; ``activation_log`` notes when both
ran. ``bench.scheduling`` runs the two against each other.
"""

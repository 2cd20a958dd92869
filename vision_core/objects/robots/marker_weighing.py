"""Teams whose robots wear different markers: how well does a hypothesis explain the pixels of its robot? Kernels.

Patches alone do not decide between two markers: one may have fewer of them, in the same places, or a team's patch of
another shape. So points all over the robot's top are looked at. A patch explains a point that has its color, the ground
between patches one that has no color of the team's markers.
"""

import numpy as np

from vision_core.native.kernels import kernel
from vision_core.objects.observation import Observation
from vision_core.objects.robots.body_points import GROUND
from vision_core.objects.robots.buffers import HEADING_BY_SHAPE, FinderBuffers
from vision_core.objects.robots.marker_reading import pixel_frame
from vision_core.objects.robots.markers import NO_DIGIT, Marker
from vision_core.types.color_cells import color_cell

HEADLESS_SHARE = 0.5
"""What a hypothesis without a heading, whose points cannot be placed, is taken to explain."""


@kernel
def weigh_hypotheses(seen: Observation, markers: tuple[Marker, ...], buffers: FinderBuffers, count: int) -> None:
    """Multiply the scores of the first ``count`` hypotheses by the share of their robots' points that they explain."""
    height, width, _ = seen.pixels.shape
    for number in range(count):
        hypothesis = buffers.hypotheses[number]
        marker = markers[hypothesis.marker]
        details = marker.details.value
        share, turn = HEADLESS_SHARE, hypothesis.heading_rad
        x0, y0, ax, ay, bx, by = pixel_frame(seen, marker, hypothesis.x_m, hypothesis.y_m, turn)
        body_px = details.body_m2 * abs(ax * by - ay * bx)
        if hypothesis.matched > 0 or hypothesis.shape_evidence == HEADING_BY_SHAPE:
            explained = 0.0
            for point in range(len(details.body_points_m)):
                along, across = details.body_points_m[point, 0], details.body_points_m[point, 1]
                u, v = x0 + along * ax + across * bx, y0 + along * ay + across * by
                column, row = min(max(int(u + 0.5), 0), width - 1), min(max(int(v + 0.5), 0), height - 1)
                pixel = seen.pixels[row, column]
                color = seen.classes[color_cell(pixel[0], pixel[1], pixel[2])]
                patch = details.body_patches[point]
                if patch == GROUND:
                    explained += not details.team_colors[color]
                elif patch == 0:
                    explained += color == marker.anchor_class
                else:
                    explained += marker.digits[patch - 1, color] != NO_DIGIT
            share = explained / max(np.float64(len(details.body_points_m)), 1.0)
        hypothesis.score *= share
        hypothesis.explained_px = share * body_px

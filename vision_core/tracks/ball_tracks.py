"""The track of the ball. There is one ball.

- Without a track, the sighting with the highest confidence starts one at once.
- With a track, the sighting **nearest to the prediction** within the gate continues it, whatever the confidence of
  sightings farther away.
- Without a sighting in the gate, the ball is predicted and marked hidden. The positions of the other sightings are
  stored, and a sighting near one of them in the next frame moves the ball there. So a false orange spot does not move
  the ball, and a ball that was carried, kicked hard or uncovered elsewhere is found in its second frame.
- A ball unseen for longer than its validity is deleted.
"""

import math

from vision_core.clock import NS_PER_S
from vision_core.native.kernels import kernel
from vision_core.tracks.filters import corrected, predicted
from vision_core.tracks.pairing import squared_gate
from vision_core.tracks.state import Row
from vision_core.types.tables import Table

BALLS = 1
"""Index of the balls in the counts of WORLD and TRACKER_STATE."""
BALLS_SEEN = 1
"""Index of the balls in the counts of SIGHTINGS."""


@kernel
def update_ball(parameters: Row, state: Row, seen: Row, at: int) -> None:
    """Process the balls of one frame, best first, grabbed at an instant later than all before.

    Rows of PARAMETERS, TRACKER_STATE and SIGHTINGS. state.balls: the ball, then other positions.
    """
    balls, count = state.balls, state.counts[BALLS]
    # Delete a ball that was not seen for too long.
    if count and at - balls[0].seen > parameters.ball_validity_ns:
        count = 0
    # Continue the track; if that fails, continue one of the other positions of the last frame.
    if count and (
        continue_ball(parameters, balls, 0, 1, seen, at) or continue_ball(parameters, balls, 1, count, seen, at)
    ):
        state.counts[BALLS] = 1
        return
    # Store this frame's sightings: the first one starts a track if there is none.
    count = min(count, 1)
    for index in range(seen.counts[BALLS_SEEN]):
        sighting = seen.balls[index]
        if math.isfinite(sighting.x_m + sighting.y_m + sighting.position_sd_m):
            ball = balls[count]
            ball.x_m, ball.y_m, ball.vx_m_s, ball.vy_m_s = sighting.x_m, sighting.y_m, 0.0, 0.0
            ball.variance = parameters.ball_noise + sighting.position_sd_m**2
            ball.covariance, ball.rate_variance = 0.0, parameters.ball_start
            ball.seen = at
            count += 1
    state.counts[BALLS] = count


@kernel
def continue_ball(parameters: Row, balls: Table, first: int, end: int, seen: Row, at: int) -> bool:
    """Continue the nearest ball of rows first..end with its nearest sighting, as row 0; False: none in a gate."""
    nearest, row, column = math.inf, -1, -1
    for place in range(first, end):
        ball = balls[place]
        t = (at - ball.seen) / NS_PER_S
        predicted_variance, _, _ = predicted(
            ball.variance, ball.covariance, ball.rate_variance, t, parameters.ball_density
        )
        for index in range(seen.counts[BALLS_SEEN]):
            sighting = seen.balls[index]
            dx, dy = sighting.x_m - ball.x_m - ball.vx_m_s * t, sighting.y_m - ball.y_m - ball.vy_m_s * t
            distance = dx**2 + dy**2
            variance = predicted_variance + parameters.ball_noise + sighting.position_sd_m**2
            if distance < nearest and distance <= squared_gate(variance, parameters.gate_m):
                nearest, row, column = distance, place, index
    if row < 0:
        return False
    balls[0] = balls[row]
    correct_ball(parameters, balls[0], seen.balls[column], at)
    return True


@kernel
def correct_ball(parameters: Row, ball: Row, sighting: Row, at: int) -> None:
    """Predict a ball to an instant and correct it with a sighting of that instant."""
    t = (at - ball.seen) / NS_PER_S
    variance, covariance, rate_variance = predicted(
        ball.variance, ball.covariance, ball.rate_variance, t, parameters.ball_density
    )
    noise = parameters.ball_noise + sighting.position_sd_m**2
    gain, rate_gain, ball.variance, ball.covariance, ball.rate_variance = corrected(
        variance, covariance, rate_variance, noise
    )
    x, y = ball.x_m + ball.vx_m_s * t, ball.y_m + ball.vy_m_s * t
    dx, dy = sighting.x_m - x, sighting.y_m - y
    ball.x_m, ball.y_m = x + gain * dx, y + gain * dy
    ball.vx_m_s += rate_gain * dx
    ball.vy_m_s += rate_gain * dy
    ball.seen = at


@kernel
def write_ball(parameters: Row, state: Row, at: int, world: Row) -> None:
    """Write the ball predicted to an instant; hidden if the last frame did not show it. world: a row of WORLD."""
    ball, track = state.balls[0], world.balls[0]
    world.counts[BALLS] = state.counts[BALLS] > 0 and at - ball.seen <= parameters.ball_validity_ns
    if not world.counts[BALLS]:
        return
    t = (at - ball.seen) / NS_PER_S
    track.x_m, track.y_m = ball.x_m + ball.vx_m_s * t, ball.y_m + ball.vy_m_s * t
    track.vx_m_s, track.vy_m_s = ball.vx_m_s, ball.vy_m_s
    variance, _, _ = predicted(ball.variance, ball.covariance, ball.rate_variance, t, parameters.ball_density)
    track.position_sd_m = math.sqrt(variance)
    track.hidden = ball.seen != state.grabbed
    track.seen = ball.seen

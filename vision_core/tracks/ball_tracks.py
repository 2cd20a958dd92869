"""The life of the ball's track. There is one ball.

- No track: the sighting with the highest confidence starts one at once.
- A track: the sighting **nearest to the prediction** within its reach continues it, however confident others
  farther away are.
- None within reach: the ball is predicted and called hidden. What was seen elsewhere is remembered, and a
  sighting near such a place in the next frame moves the ball there. So a false orange spot moves nothing, and
  a ball that was carried, kicked hard or uncovered elsewhere is found in its second frame.
- Unseen for longer than its validity: it is gone.
"""

import math

from vision_core.clock import NS_PER_S
from vision_core.native.kernels import kernel
from vision_core.tracks.filters import corrected, predicted
from vision_core.tracks.pairing import reach_m2
from vision_core.tracks.state import Row
from vision_core.types.tables import Table

BALLS = 1
"""Place of the balls in the counts of a world and of the state."""
BALLS_SEEN = 1
"""Place of the balls in a sightings table's counts."""


@kernel
def update_ball(rules: Row, state: Row, seen: Row, at: int) -> None:
    """Take in one frame's balls, best first, grabbed at an instant later than all before.

    Rows of RULES, STATE and SIGHTINGS. state.balls: the ball, then places elsewhere.
    """
    balls, count = state.balls, state.counts[BALLS]
    if count and at - balls[0].seen > rules.ball_validity_ns:
        count = 0
    if count and (continued(rules, balls, 0, 1, seen, at) or continued(rules, balls, 1, count, seen, at)):
        state.counts[BALLS] = 1
        return
    count = min(count, 1)
    for index in range(seen.counts[BALLS_SEEN]):
        sighting = seen.balls[index]
        if math.isfinite(sighting.x_m + sighting.y_m + sighting.position_sd_m):
            ball = balls[count]
            ball.x_m, ball.y_m, ball.vx_m_s, ball.vy_m_s = sighting.x_m, sighting.y_m, 0.0, 0.0
            ball.variance = rules.ball_noise + sighting.position_sd_m**2
            ball.covariance, ball.rate_variance = 0.0, rules.ball_start
            ball.seen = at
            count += 1
    state.counts[BALLS] = count


@kernel
def continued(rules: Row, balls: Table, first: int, end: int, seen: Row, at: int) -> bool:
    """Move the ball to the pair of a place (rows first..end) and a sighting that lie nearest to each other within
    reach, when there is one."""
    nearest, row, column = math.inf, -1, -1
    for place in range(first, end):
        life = balls[place]
        t = (at - life.seen) / NS_PER_S
        ahead, _, _ = predicted(life.variance, life.covariance, life.rate_variance, t, rules.ball_density)
        for index in range(seen.counts[BALLS_SEEN]):
            sighting = seen.balls[index]
            dx, dy = sighting.x_m - life.x_m - life.vx_m_s * t, sighting.y_m - life.y_m - life.vy_m_s * t
            distance = dx**2 + dy**2
            variance = ahead + rules.ball_noise + sighting.position_sd_m**2
            if distance < nearest and distance <= reach_m2(variance, rules.gate_m):
                nearest, row, column = distance, place, index
    if row < 0:
        return False
    balls[0] = balls[row]
    correct_ball(rules, balls[0], seen.balls[column], at)
    return True


@kernel
def correct_ball(rules: Row, ball: Row, sighting: Row, at: int) -> None:
    """Continue a ball with a sighting."""
    t = (at - ball.seen) / NS_PER_S
    variance, covariance, rate_variance = predicted(
        ball.variance, ball.covariance, ball.rate_variance, t, rules.ball_density
    )
    noise = rules.ball_noise + sighting.position_sd_m**2
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
def write_ball(rules: Row, state: Row, at: int, world: Row) -> None:
    """The ball predicted to an instant; hidden if the last frame did not show it. world: a row of WORLD."""
    ball, track = state.balls[0], world.balls[0]
    world.counts[BALLS] = state.counts[BALLS] > 0 and at - ball.seen <= rules.ball_validity_ns
    if not world.counts[BALLS]:
        return
    t = (at - ball.seen) / NS_PER_S
    track.x_m, track.y_m = ball.x_m + ball.vx_m_s * t, ball.y_m + ball.vy_m_s * t
    track.vx_m_s, track.vy_m_s = ball.vx_m_s, ball.vy_m_s
    variance, _, _ = predicted(ball.variance, ball.covariance, ball.rate_variance, t, rules.ball_density)
    track.position_sd_m = math.sqrt(variance)
    track.hidden = ball.seen != state.grabbed
    track.seen = ball.seen

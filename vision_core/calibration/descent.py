"""Levenberg-Marquardt over any state: damped steps of the normal equations, each taken only when the loss falls."""

from collections.abc import Callable
from typing import Protocol, TypeVar

import numpy as np

from vision_core.geometry import Floats

FIRST_DAMPING, LEAST_DAMPING, MAX_DAMPING = 1e-4, 1e-9, 1e6
SETTLED = 1e-5
"""A step that moves no parameter by more than this share of its unit is the last one."""

State = TypeVar("State")


class Problem(Protocol[State]):
    """Residuals with their weights, as a robust loss has them near one state."""

    def loss(self, state: State, /) -> float:
        """What shall become small; inf where the state is none."""

    def normal_equations(self, state: State, /) -> tuple[Floats, Floats]:
        """Gradient, shape (p,), and information, shape (p, p), by parameters in their units."""

    def moved(self, state: State, step: Floats, /) -> State:
        """The state after a step of the parameters in their units, shape (p,)."""


def descend(state: State, problem_at: Callable[[State], Problem[State]], steps: int) -> State:
    """The state of least loss that so many steps reach. problem_at: the problem near a state, after each step anew."""
    damping = FIRST_DAMPING
    problem = problem_at(state)
    loss = problem.loss(state)
    for _ in range(steps):
        gradient, information = problem.normal_equations(state)
        while damping < MAX_DAMPING:
            damped = information + damping * np.diag(np.diag(information) + 1.0)
            step = np.asarray(-np.linalg.solve(damped, gradient), dtype=np.float64)
            moved = problem.moved(state, step)
            reached = problem.loss(moved)
            if reached < loss:
                break
            damping *= 10.0
        else:
            break
        state, damping = moved, max(damping * 0.1, LEAST_DAMPING)
        problem = problem_at(state)
        loss = problem.loss(state)
        if np.abs(step).max() < SETTLED:
            break
    return state

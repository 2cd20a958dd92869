"""One world as the paper shows it: its four figures, and where both sides disagree."""

from vision_core.errors import SourceError
from vision_core.fidelity.ceiling import CeilingSide
from vision_core.fidelity.experiment import Comparison, Tally, add, evidence
from vision_core.fidelity.figures import doubled, figure_3, figure_4, figure_6, marked, side_by_side
from vision_core.fidelity.onboard import OnboardSide
from vision_core.fidelity.worlds import Setup, random_world
from vision_core.geometry import Bytes


def demonstrate(setup: Setup, seed: int) -> tuple[Comparison, dict[str, Bytes]]:
    """A world's comparison and its figures by name: figure-3, 4, 6, 7, disagreement, and figures, all of them.

    Raises SourceError when the ceiling camera does not find the viewer.
    """
    ceiling, onboard = CeilingSide(setup), OnboardSide(setup, setup.mirror)
    snapshot = random_world(ceiling.settings, seed)
    scene = onboard.scene(snapshot)
    picture = onboard.picture(scene)
    tally = Tally(setup)
    add(tally, seed, snapshot, onboard.report(picture), evidence(snapshot, scene, ceiling, onboard), ceiling)
    if not tally.comparisons:
        raise SourceError(f"the world of seed {seed}", found="robot A is not found", accepted="another seed or camera")
    comparison = tally.comparisons[0]
    told = comparison.told
    larger = max(640 // setup.onboard_px[0], 1)
    figures = {
        "figure-3": figure_3(
            ceiling.picture(snapshot), ceiling.camera.model, snapshot, onboard.camera.row, told, setup.mirror
        ),
        "figure-4": figure_4(told, setup.mirror.horizon_px),
        "figure-6": figure_6(told, setup.mirror),
        "figure-7": picture,
        "disagreement": marked(doubled(picture, 1), onboard.camera, comparison),
    }
    figures["figures"] = side_by_side(
        {
            "Figure 3: nearest edges of robot A from the ceiling": figures["figure-3"],
            "Figure 4: the edge array of robot A": figures["figure-4"],
            "Figure 6: pseudo-local vision": doubled(figures["figure-6"], 2),
            "Figure 7: the on-board camera (rendered)": doubled(picture, larger),
        }
    )
    return comparison, figures

"""Of each blob of a team's color: what it was taken for, or the gate that stopped it."""

from tests.objects.drawing import Picture
from tests.objects.finding import empty_picture, middle, scene_of, settings_of
from vision_core.objects.robots.finder import robot_finder
from vision_core.objects.robots.verdicts import robot_verdicts
from vision_core.patterns.loader import load_pattern
from vision_core.types.overlay import Hypothesis

SSL = load_pattern("ssl-standard")
HEIGHT_M = SSL.robot.height_m


def picture(robots: float = 3.0) -> tuple[Picture, float, float]:
    drawn = empty_picture(SSL, robots, 36.0)
    return drawn, *middle(drawn, HEIGHT_M)


def verdicts(drawn: Picture, min_confidence: float = 0.3) -> list[Hypothesis]:
    scene, settings = scene_of(drawn), settings_of("ssl-standard", min_confidence=min_confidence)
    return [shown for _, shown in robot_verdicts(scene, robot_finder(settings, scene.table), settings)]


def test_a_robot_is_accepted_with_its_id() -> None:
    drawn, x, y = picture()
    drawn.paint_robot("blue", SSL.code_by_id[3], x, y, 0.3)
    (robot,) = verdicts(drawn)
    assert (robot.what, robot.is_accepted, robot.id, robot.gate) == ("blue robot", True, 3, "")
    assert robot.confidence is not None
    assert robot.confidence > 0.7
    assert 15.0 < robot.radius_px < 21.0


def test_a_circle_of_the_wrong_size_is_said_in_pixels() -> None:
    drawn, x, y = picture()
    drawn.paint_disc("blue", x, y, 0.075, HEIGHT_M)
    (blob,) = verdicts(drawn)
    assert not blob.is_accepted
    assert blob.gate == "of the wrong size (robots.min_area, robots.max_area)"
    assert blob.found == "circle 30.9 px across"
    assert blob.accepted == "5.7 to 14.7 px"


def test_a_team_patch_alone_lacks_its_others() -> None:
    drawn, x, y = picture()
    drawn.paint_robot("blue", "----", x, y, 0.0)
    (blob,) = verdicts(drawn)
    assert blob.gate == "without another patch of its marker"
    assert blob.accepted == "some of the 4 other patches of pattern ssl-standard"


def test_too_little_confidence_names_the_missing_patch() -> None:
    drawn, x, y = picture()
    drawn.paint_robot("blue", "P-PP", x, y, 0.0)
    (blob,) = verdicts(drawn, min_confidence=0.9)
    assert blob.gate == "below robots.min_confidence"
    assert "4 of the 5 patches" in blob.found
    assert "there is nothing pink or green" in blob.found
    assert blob.accepted == "0.9 or more"


def test_a_robot_without_an_id_is_accepted_and_says_what_it_lacks() -> None:
    drawn, x, y = picture()
    drawn.paint_robot("blue", "P-PP", x, y, 0.0)
    (robot,) = verdicts(drawn)
    assert (robot.is_accepted, robot.id, robot.gate) == (True, None, "without an id")
    assert "there is nothing pink or green" in robot.found


def test_two_robots_with_one_marker_have_no_id() -> None:
    drawn, x, y = picture()
    drawn.paint_robot("blue", SSL.code_by_id[3], x - 0.1, y, 0.3)
    drawn.paint_robot("blue", SSL.code_by_id[3], x + 0.1, y, 0.3)
    assert [(robot.id, robot.found) for robot in verdicts(drawn)] == [
        (None, "the marker of another robot of its team")
    ] * 2


def test_a_second_center_in_a_robot_has_no_place() -> None:
    drawn, x, y = picture()
    drawn.paint_robot("blue", SSL.code_by_id[3], x, y, 0.0)
    drawn.paint_disc("blue", x - 0.085, y, 0.02, HEIGHT_M)
    stopped = [blob for blob in verdicts(drawn, min_confidence=0.1) if not blob.is_accepted]
    assert [blob.gate for blob in stopped] == ["in the place of a better robot"]
    assert "the blue robot at (54, 54) px has confidence" in stopped[0].found

"""What is refused says what is missing; what is accepted says how sure it is."""

import numpy as np
import pytest

from vision_core.calibration.mirror.fit import FocalPrior
from vision_core.calibration.mirror.pairs import pairs_of
from vision_core.calibration.mirror.result import MirrorCalibration
from vision_core.calibration.mirror.rounding import Rounding
from vision_core.calibration.mirror.verdict import calibrate_mirror
from vision_core.calibration.result import Cancelled
from vision_core.models.mirror import PAPER_MIRROR
from vision_core.types.job_step import JobStep
from vision_core.venues.presets import field_of

DISTANCES = [110.0, 150.0, 220.0, 300.0, 380.0, 500.0, 700.0, 1000.0, 1500.0, 2000.0, 2750.0]
FOCAL = FocalPrior(300.0, 0.1)
Row = tuple[float, float]


def rows_at(distances: list[float]) -> list[Row]:
    return [(round(PAPER_MIRROR.px_from_mm(distance), 1), distance) for distance in distances]


def judged(rows: list[Row], prior: FocalPrior | None = FOCAL, rounding: Rounding = Rounding.EXACT) -> MirrorCalibration:
    return calibrate_mirror(pairs_of(rows, rounding=rounding), prior)


def refusal(rows: list[Row], prior: FocalPrior | None = FOCAL) -> str:
    result = judged(rows, prior)
    assert not result.accepted
    return "; ".join(map(str, result.reasons))


def test_the_worked_example_gives_its_mirror() -> None:
    result = judged(rows_at(DISTANCES))
    assert result.accepted, result.reasons
    assert result.mirror is not None
    distances = np.linspace(100.0, 2500.0, 50)
    assert result.mirror.px_from_mm(distances) == pytest.approx(PAPER_MIRROR.px_from_mm(distances), abs=0.1)
    assert result.rms_px < 0.05
    assert result.band_px < 0.2
    assert [point.r_mm for point in (result.curve[0], result.curve[-1])] == [100.0, 2500.0]
    deviations = np.sqrt(np.diag(np.array(result.covariance)))
    assert 0.15 < deviations[2] / result.mirror.c < 0.2, "f is known to a tenth, and C is its square"
    assert "px rms over 11 pairs" in result.words[0]
    assert "A, B, C are not individually meaningful (A to 17%" in result.words[2]
    assert "the curve is" in result.words[2]
    assert JobStep.of(result).found(MirrorCalibration) == result


def test_too_few_distances() -> None:
    said = refusal(rows_at([110.0, 150.0, 300.0, 500.0, 1000.0]))
    assert "pairs at 5 distances agree, 6 are needed. Add pairs at other distances, 1 more." in said
    assert "3 distances are not enough for three constants" in refusal(rows_at(DISTANCES[:3]))
    assert "0 distances" in refusal([])
    repeated = [(25.0, 110.0), (25.1, 110.5), (24.9, 109.8), (60.0, 360.0), (60.1, 361.0), (90.0, 1200.0)]
    assert "3 distances are not enough" in refusal(repeated)


def test_too_small_a_span() -> None:
    said = refusal(rows_at([300.0, 400.0, 500.0, 600.0, 700.0, 800.0]))
    assert "the longest distance, 800 mm, is only 2.7 times the shortest, 5 times are needed" in said
    assert "beyond 1500 mm, or nearer than 160 mm" in said


def test_an_outlier_is_named_and_does_not_give_the_span() -> None:
    rows = rows_at(DISTANCES)
    result = judged([*rows, (80.0, 380.0)])
    assert result.accepted, result.reasons
    assert "row 12 (+18.5 px) left out" in result.notes[0]
    assert [pair.counts for pair in result.pairs] == [True] * 11 + [False]
    assert result.pairs[-1].off_px == pytest.approx(18.5, abs=0.2)
    said = refusal([*rows_at([300.0, 350.0, 400.0, 500.0, 600.0, 700.0, 800.0, 900.0]), (140.0, 2500.0)])
    assert "the longest distance, 900 mm" in said


def test_pairs_that_contradict_each_other() -> None:
    mixed = [(px, mm) for (px, _), mm in zip(rows_at(DISTANCES), DISTANCES[::-1], strict=True)]
    said = refusal(mixed)
    assert "the pairs contradict each other" in said
    assert "row 11 says 100 px at 110 mm, but row 1 only 25 px at 2750 mm" in said
    twice = [*rows_at(DISTANCES), *((px - 30.0, mm) for px, mm in rows_at(DISTANCES)[3:])]
    assert "row 5 and row 13 say 61.5 and 31.5 px at 380 mm" in refusal(twice)


def test_two_readings_of_which_either_may_be_wrong() -> None:
    near = rows_at([100.0, 110.0, 120.0, 130.0, 140.0, 150.0])
    said = refusal([*near, (93.3, 1500.0), (97.0, 1500.0)])
    assert "either row 7 or row 8 is wrong, and the other pairs do not tell which" in said


def test_a_curve_that_is_known_nowhere_far_is_refused() -> None:
    noisy = [(px + (0.8 if number % 2 else -0.8), mm) for number, (px, mm) in enumerate(rows_at(DISTANCES[:6]))]
    far = [(19.0, 80.0), *noisy]
    assert "px off at 2500 mm. Add pairs near that distance" in refusal(far, None)


def test_columns_and_units_that_were_confused() -> None:
    assert "columns exchanged" in refusal([(mm, px) for px, mm in rows_at(DISTANCES)])
    assert "distances in metres" in refusal([(px, mm / 1e3) for px, mm in rows_at(DISTANCES)])


def test_a_mirror_that_breaks_a_rule_is_named() -> None:
    large = [(3.0 * px, mm) for px, mm in rows_at(DISTANCES)]
    result = judged(large, None)
    assert result.mirror is None
    assert "the horizon at 32" in result.reasons[0].text
    assert "a horizon of 20..254 px" in result.reasons[0].text


def test_the_field_wants_its_diagonal() -> None:
    pairs = pairs_of([(px * 0.22, mm) for px, mm in rows_at(DISTANCES)])
    assert calibrate_mirror(pairs, None).accepted
    result = calibrate_mirror(pairs, None, field_of("vsss"))
    assert "px between one metre and the diagonal; accepted: at least 3 px" in result.reasons[0].text


def test_a_focal_length_that_the_pairs_contradict_moves_the_curve_little_and_is_noted() -> None:
    result = judged(rows_at(DISTANCES), FocalPrior(1200.0, 0.05))
    assert result.worst_px < 0.15
    assert "a focal length of 317 px, not 1200 px as given" in result.notes[0]


def test_notes() -> None:
    whole = [(float(int(px)), mm) for px, mm in rows_at(DISTANCES)]
    result = judged(whole, None, Rounding.AUTO)
    assert result.accepted
    assert result.notes[0].startswith("radii count as cut by int() (all radii are whole numbers): 0.5 px were added")
    assert "no focal length was given" in result.notes[1]
    bent = [(px + 0.3 * np.sin(3.0 * np.log(mm)), mm) for px, mm in rows_at(np.geomspace(110.0, 2750.0, 60).tolist())]
    assert any("the residuals are no noise" in note for note in judged(bent).notes)


def test_a_calibration_is_cancelled() -> None:
    def progress(_what: str, _share: float) -> None:
        raise Cancelled

    with pytest.raises(Cancelled):
        calibrate_mirror(pairs_of(rows_at(DISTANCES)), FOCAL, progress=progress)

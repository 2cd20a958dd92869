"""The table of edge types."""

import pytest

from vision_core.types.edges import EDGE_TYPES, EdgeKind, all_letters, edge_type_of, letter_faults


def test_every_kind_has_one_row_and_no_code_has_two() -> None:
    assert [edge.kind for edge in EDGE_TYPES] == list(EdgeKind)
    codes = [code for edge in EDGE_TYPES for code in edge.codes]
    assert len(set(codes)) == len(codes)
    assert max(codes) < 256


def test_the_default_letters_are_in_order() -> None:
    assert not list(letter_faults({}))
    assert len({letter.key for letter in all_letters()}) == len(all_letters())


def test_a_code_is_found_in_its_row() -> None:
    assert edge_type_of(EdgeKind.ROBOT_YELLOW + 16).kind == EdgeKind.ROBOT_YELLOW
    assert edge_type_of(0).kind == EdgeKind.NOTHING
    with pytest.raises(ValueError, match="edge code 99 is in no row"):
        edge_type_of(99)

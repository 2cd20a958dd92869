"""Messages are one readable line, whatever they quote."""

from vision_core.errors import MAX_ACCEPTED, MAX_QUOTED, PslvError, cut


def test_what_a_message_quotes_is_cut_and_keeps_both_ends() -> None:
    error = PslvError("pattern " + "x" * 5000 + ".toml: name", found="y" * 5000, accepted="z" * 5000)
    assert (len(error.asked), len(error.found), len(error.accepted)) == (MAX_QUOTED, MAX_QUOTED, MAX_ACCEPTED)
    assert error.asked.startswith("pattern xxx")
    assert error.asked.endswith(".toml: name")
    assert " ... " in error.found


def test_a_short_text_and_a_whole_sentence_stay_as_they_are() -> None:
    assert cut("x" * MAX_QUOTED) == "x" * MAX_QUOTED
    sentence = "word " * 100
    assert str(PslvError(sentence)) == sentence

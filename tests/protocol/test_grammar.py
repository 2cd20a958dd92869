"""The grammar of docs/protocol.md is the one that the codec reads and writes."""

import random
import re
from pathlib import Path

import pytest

from tests.protocol.grammar import Grammar, Lexical, read_rules, words_of
from tests.protocol.vectors import datagram_of, named, vectors
from vision_core.protocol.answers import DECODERS, decode_message
from vision_core.protocol.commands import COMMANDS, MAX_COMMAND, decode_commands
from vision_core.protocol.messages import PLAY_MODES
from vision_core.protocol.options import EXTRAS, OPTION_PARSERS, options_from_forms
from vision_core.protocol.s_expressions import parse_forms

PAGE = (Path(__file__).parents[2] / "docs" / "protocol.md").read_text(encoding="utf-8")
SENTENCES = 400
REAL = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:e[+-]?[0-9]+)?"
TIME = r"[0-9]{1,10}(?:\.[0-9]*)?"
COOKIE = "0123456789abcdef01234567"
LEXICAL = {
    "Time": Lexical(TIME, ("0", "20306.148", "20306.148123")),
    "hold": Lexical(REAL, ("0.4", "0", "1.5e1")),
    "client": Lexical(REAL, ("6.5", "12")),
    "id": Lexical("-?[0-9]+", ("0", "7", "-7", "9223372036854775807")),
    "Vx": Lexical(REAL, ("0.5", "0", "-1.25")),
    "Vy": Lexical(REAL, ("0", ".5")),
    "Omega": Lexical(REAL, ("-3.1", "1e1")),
    "speed": Lexical(REAL, ("4", "2.5")),
    "T1": Lexical("-?[0-9]+", ("123456789012345678", "-5")),
    "T2": Lexical("-?[0-9]+", ("20306148000000",)),
    "T3": Lexical("-?[0-9]+", ("20306148000001",)),
    "key": Lexical("[!-'*-~]{1,128}", ("zx-9_k", "k" * 128)),
    "cookie": Lexical("[0-9a-f]{24}", (COOKIE,)),
    "version": Lexical("[1-9][0-9]*", ("1", "2", "7")),
    "A": Lexical(REAL, ("4.0187", "4.1")),
    "B": Lexical(REAL, ("0.0125935", "1.25935e-2")),
    "C": Lexical(REAL, ("90000", "9e4")),
    "width": Lexical(REAL, ("90", "180", "360", "112.5")),
    "center": Lexical(REAL, ("0", "180", "-90", "45.5")),
    "step": Lexical(REAL, ("1", "1.5", "10")),
    "rate": Lexical("[1-9][0-9]{0,3}", ("1", "30", "1000")),
    "mode": Lexical("|".join(PLAY_MODES), tuple(sorted(PLAY_MODES))),
    "name": Lexical("[a-z_]{1,39}", ("seq", "illegal_form", "later")),
    "word": Lexical("[!-'*-~]+", ("1234", "20306.153210", "partial")),
    "edges": Lexical("(?:[!-'*-~][0-9a-f]{2})+", ("w2c", "w2cx5a-ff", "-ff" * 448)),
    "mm": Lexical("-?[0-9]+", ("0", "-35", "1200")),
    "heading": Lexical(f"-|{REAL}", ("-", "90.0", "-179.9")),
    "distance": Lexical("-1|[0-9]{1,3}", ("-1", "0", "61", "254")),
    "direction": Lexical("[0-9]{1,3}", ("0", "121", "359")),
    "size": Lexical("[0-9]{1,3}", ("0", "3", "360")),
}
"""The words that the page describes in prose."""


def block(first_rule: str) -> str:
    """The indented block of the page that begins with a rule."""
    found = re.findall(rf"(?:^    {first_rule} +=.*\n)(?:    .*\n)*", PAGE, flags=re.MULTILINE)
    assert len(found) == 1
    return str(found[0])


OF_CLIENTS = Grammar(read_rules(block("datagram")), LEXICAL)
OF_SERVERS = Grammar({**OF_CLIENTS.rules, **read_rules(block("message"))}, LEXICAL)


def canonical(datagram: bytes) -> str:
    """A client's datagram without what the page says beside the grammar: case, NUL, and the two other forms of init."""
    text = datagram.decode("latin-1").removesuffix("\0").strip().lower()
    return re.sub(r"\((?:team|number) (\w+)\)", r"\1", text)


def test_every_word_has_a_rule_or_is_described() -> None:
    assert OF_CLIENTS.undefined() | OF_SERVERS.undefined() == set(LEXICAL)


def test_the_grammar_names_every_command_option_extra_and_message() -> None:
    rules = OF_CLIENTS.rules
    assert set(rules) == {"datagram", "form", "team", "number", "option", "extra", *COMMANDS}
    assert set(read_rules(block("message"))) == {"message", "see", *DECODERS}
    options = re.findall(r'"\((\w+)', block("datagram").partition("option    =")[2])
    assert sorted(options) == sorted([*OPTION_PARSERS, "cookie", "key"])
    assert all(OF_CLIENTS.accepts("extra", extra) for extra in EXTRAS)


@pytest.mark.parametrize("kind", ["commands", "illegal_form", "unknown_command", "illegal_team", "illegal_number"])
def test_a_datagram_is_of_the_grammar_if_the_server_takes_it(kind: str) -> None:
    of_kind = [vector for vector in vectors("client_to_server") if kind in (*vector, vector.get("error"))]
    assert of_kind
    for vector in of_kind:
        commands, datagram = vector.get("commands", ()), datagram_of(vector)
        if any(command.get("unknown_options") for command in commands):
            continue  # of a version that this page does not know
        too_many = len(parse_forms(datagram.strip(b"\0")) or ()) < datagram.count(b"(ping)")  # said beside the grammar
        expected = kind == "commands" or too_many or vector["about"] == "not within 64 bits"
        assert OF_CLIENTS.accepts("datagram", canonical(datagram)) == expected, vector


def test_what_gets_no_answer_is_not_of_the_grammar() -> None:
    for vector in vectors("client_to_server"):
        if "answer" in vector and len(datagram_of(vector)) <= MAX_COMMAND:
            assert not OF_CLIENTS.accepts("datagram", canonical(datagram_of(vector))), vector


def breaks_a_rule(sentence: str) -> bool:
    """Has it an option or extra twice, or an extra in version 1? The page says that beside the grammar."""
    for form in parse_forms(sentence.encode()) or ():
        options = [part for part in form if isinstance(part, tuple)]
        names = [option[0] for option in options]
        extras = [word for option in options if option[0] == "extra" for word in option[1:]]
        has_version_2 = any(option[0] == "version" and option[1] != "1" for option in options)
        if len(set(names)) < len(names) or len(set(extras)) < len(extras) or (extras and not has_version_2):
            return True
    return False


@pytest.mark.parametrize("rule", sorted(COMMANDS))
def test_the_server_takes_every_sentence_of_the_grammar(rule: str) -> None:
    rng, taken = random.Random(rule), 0
    for _ in range(SENTENCES):
        sentence = OF_CLIENTS.sentence(rule, rng)
        assert OF_CLIENTS.accepts("datagram", sentence)
        if breaks_a_rule(sentence):
            continue
        request = decode_commands(sentence.encode())
        assert request is not None, sentence
        (command,) = request.commands
        assert named(command)["form"] == rule, sentence
        taken += 1
    assert taken > SENTENCES / 10


def test_set_takes_every_option_of_the_grammar_but_those_that_init_fixes() -> None:
    rng = random.Random(1)
    for _ in range(SENTENCES):
        option = OF_CLIENTS.sentence("option", rng)
        if option.startswith(("(version", "(cookie", "(key")) or breaks_a_rule(f"(set (version 2) {option})"):
            continue
        forms = parse_forms(f"(set (version 2) {option})".encode())
        assert forms is not None
        assert isinstance(options_from_forms(forms[0][1:]), tuple), option


@pytest.mark.parametrize("rule", sorted(["see", *DECODERS]))
def test_a_client_understands_every_message_of_the_grammar(rule: str) -> None:
    rng = random.Random(rule)
    for _ in range(SENTENCES):
        sentence = OF_SERVERS.sentence(rule, rng)
        assert OF_SERVERS.accepts("message", sentence)
        assert decode_message(sentence.encode()) is not None, sentence


def test_messages_that_a_server_of_today_sends_are_of_the_grammar() -> None:
    later = "a later version", "the order of the pairs is free", "something of a later version"
    for vector in vectors("server_to_client"):
        text = str(vector["datagram"]).removesuffix("\0")
        if vector["message"] is None:
            assert not (text.isascii() and len(text) < 2000 and OF_SERVERS.accepts("message", text)), vector
        elif not any(word in vector["about"] for word in later):
            assert OF_SERVERS.accepts("message", text), vector


def test_the_reader_refuses_what_is_no_grammar() -> None:
    for wrong in ('a = "x', "a = {b", "a b", "a = b a = c", "a = b # c"):
        with pytest.raises((ValueError, IndexError)):
            read_rules(wrong)
    assert words_of("((edge) w2c)") == ("(", "(", "edge", ")", "w2c", ")")

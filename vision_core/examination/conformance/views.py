"""Rules about views."""

import itertools
import re
import time

from vision_core.examination.conformance.probe import Broken, Client, Probe, Received, Skipped, shown
from vision_core.examination.conformance.rule import RuleBook

BOOK = RuleBook()
SEE = re.compile(
    r"\(see (0|[1-9][0-9]{0,9})\.([0-9]{3}|[0-9]{6})"
    r" \(\(edge\) ((?:[!-'*-~][0-9a-f]{2})*)\)"
    r" \(\(ball\) (-1|[0-9]{1,3}) ([0-9]{1,3}) ([0-9]{1,3})\)"
    r"((?: \(\(\w+\)[^()]*\))*)\)\0?"
)
VIEWS = 10
RATE_HZ, RATE_S = 5, 2.0


def read(view: Received) -> re.Match[str]:
    """The parts of a view. Raises Broken."""
    match = SEE.fullmatch(view.text)
    if match is None:
        raise Broken(f"(see Time ((edge) ...) ((ball) px deg deg)) with exact spaces expected; {shown(view.text)} came")
    return match


def edges_of(match: re.Match[str]) -> list[str]:
    """Three characters each."""
    return re.findall("...", match[3])


def open_unfixed(client: Client, options: str) -> None:
    """Open a session whose views are as it asks. Raises Skipped when a match fixes them."""
    client.open(options)
    if (told := client.answer(0.2)) is not None and "fixed_by_match" in told.text:
        raise Skipped("a match fixes what robots see")


@BOOK.rule("The spaces of `see` are those of the sample above, exactly.")
def a_view_has_the_form_of_the_paper(probe: Probe) -> None:
    with probe.client() as client:
        open_unfixed(client, "")
        for view in client.views(VIEWS):
            match = read(view)
            if len(edges_of(match)) != 360 or len(match[2]) != 3 or match[7]:
                found = f"{len(edges_of(match))} edges, {len(match[2])} decimals"
                raise Broken(f"360 edges, 3 decimals and no extras expected; {found}, extras '{match[7]}' came")


@BOOK.rule("Strictly increasing within a session.")
def time_grows(probe: Probe) -> None:
    with probe.client() as client:
        client.open()
        times = [float(f"{match[1]}.{match[2]}") for match in map(read, client.views(VIEWS))]
        if any(later <= earlier for earlier, later in itertools.pairwise(times)):
            raise Broken(f"growing times expected; {times} came")


@BOOK.rule("The largest distance is `fe`; `-ff` means that there is nothing within range.")
def ff_is_nothing_and_nothing_is_ff(probe: Probe) -> None:
    with probe.client() as client:
        client.open()
        for view in client.views(VIEWS):
            wrong = [edge for edge in edges_of(read(view)) if (edge[0] == "-") != (edge[1:] == "ff")]
            if wrong:
                raise Broken(f"-ff for nothing, and at most fe else expected; {wrong[0]} came")


@BOOK.rule("A hidden ball is `((ball) -1 0 0)`.")
def the_ball_is_hidden_or_somewhere(probe: Probe) -> None:
    with probe.client() as client:
        client.open()
        for view in client.views(VIEWS):
            px, direction, size = (int(part) for part in read(view).groups()[3:6])
            hidden = (px, direction, size) == (-1, 0, 0)
            if not hidden and not (0 <= px <= 254 and direction <= 359 and 1 <= size <= 360):
                raise Broken(f"-1 0 0, or 0..254 px, 0..359 and 1..360 deg expected; {px} {direction} {size} came")


@BOOK.rule("three or six decimals")
def time_has_six_decimals_if_asked(probe: Probe) -> None:
    with probe.client() as client:
        client.open("(time us)")
        match = read(client.view())
        if len(match[2]) != 6:
            raise Broken(f"six decimals expected; {match[1]}.{match[2]} came")


@BOOK.rule("there are floor(W / D) of them, at most 448")
def directions_are_as_many_as_asked(probe: Probe) -> None:
    with probe.client() as client:
        for options, count in (("(fov 90)", 90), ("(fov 112) (resolution 0.25)", 448), ("(resolution 7)", 51)):
            open_unfixed(client, options)
            client.view()  # it may have been sent before
            found = [len(edges_of(read(view))) for view in client.views(2)][-1]
            if found != count:
                raise Broken(f"{count} directions expected for {options}; {found} came")
        client.expect_error(probe.init("(resolution 0.5)"), "illegal_option", probe.port)


@BOOK.rule("at most N views a second, 1..1000; other frames are left out, never sent later")
def a_rate_is_kept(probe: Probe) -> None:
    with probe.client() as client:
        open_unfixed(client, f"(rate {RATE_HZ})")
        client.view()
        end, count = time.monotonic() + RATE_S, 0
        while (left_s := end - time.monotonic()) > 0.0:
            received = client.receive(left_s)
            count += received is not None and received.is_view
        if count > RATE_HZ * RATE_S + 1:
            raise Broken(f"at most {RATE_HZ} views a second expected; {count} came in {RATE_S:g} s")

"""``pslv compile``: compile the kernels before the first start."""

from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.table import Table

from app.commands.options import ConfigFile, Venue
from app.commands.progress import Progress, print_line

if TYPE_CHECKING:
    from vision_core.native.kernel_folder import CompiledKernel


def compile_command(
    venue: Venue = None,
    config: ConfigFile = None,
    source: Annotated[str | None, typer.Option(envvar="PSLV_SOURCE", help="The source that kernels are for.")] = None,
    report: Annotated[bool, typer.Option("--report", help="List every kernel with the time that it took.")] = False,
) -> None:
    """Compile all kernels that a start with these settings needs; a start does the same when something is missing."""
    from vision_core.native.kernel_folder import choose_kernel_folder, compiled_kernels, kernel_files
    from vision_core.startup.compile import compile_kernels
    from vision_core.venues.loader import layers_of, settings_from_layers

    settings = settings_from_layers(layers_of(venue, config, {"source.uri": source}))
    progress = Progress()
    try:
        compile_kernels(settings, show=progress.show, log=print_line, go_on=lambda: True)
    finally:
        progress.show("")
    if not report:
        return
    folder, _ = choose_kernel_folder()
    assert folder is not None  # compile_kernels has just used it
    typer.echo(f"compiled kernels in {folder.path}")
    Console(highlight=False).print(_table(compiled_kernels(folder, kernel_files(folder))))


def _table(kernels: "list[CompiledKernel]") -> Table:
    """Seconds and signatures of each kernel, the longest first."""
    seconds: dict[str, list[float]] = {}
    for kernel in kernels:
        seconds.setdefault(kernel.kernel, []).append(kernel.seconds)
    table = Table(box=None, pad_edge=False)
    for title in ("kernel", "signatures", "processor time [s]"):
        table.add_column(title, justify="left" if title == "kernel" else "right")
    for name, took in sorted(seconds.items(), key=lambda item: -sum(item[1])):
        table.add_row(name, str(len(took)), f"{sum(took):.2f}")
    table.add_section()
    table.add_row(f"all {len(seconds)} kernels", str(len(kernels)), f"{sum(kernel.seconds for kernel in kernels):.2f}")
    return table

"""Everything round the core: command line, supervisor, web process.

main             entry point, standard library only
cli              the command line: registers
commands/        one file per command
launch/          from settings to what is started: plan, sockets, who holds a port
supervisor/      starts and watches every process of the service
web/             the page's process: API, live connection, reports
"""

from importlib.metadata import version

__version__ = version("pslv")

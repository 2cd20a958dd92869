"""A warm spare that loads nothing but the modules it is told of, for the supervisor's tests."""

import sys
from importlib import import_module

from vision_core.startup.spare import attach_in_background, wait_and_become


def main() -> None:
    attachment = attach_in_background()
    for name in sys.argv[1:]:
        import_module(name)
    wait_and_become(attachment)


if __name__ == "__main__":
    main()

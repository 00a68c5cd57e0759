# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The command cg2raw. Each module here without a leading underscore is a subcommand.

Such a module has a docstring, whose first line is its help, add_arguments(parser), and
run(arguments), which returns the exit code: 0, or 1 for "no" where there is a question.
A ValueError, OSError or MemoryError that leaves run is printed as one line, with exit
code 1; argparse exits with 2 on a wrong command line.
"""

import argparse
import importlib
import io
import os
import pkgutil
import sys
from collections.abc import Sequence
from types import ModuleType

from cg2raw import __version__
from cg2raw.cli._completion import SHELLS, PrintCompletion
from cg2raw.cli._messages import about_output, check_words, with_command, with_ranges
from cg2raw.short_messages import Parser


def subcommands() -> dict[str, ModuleType]:
    """Return {name: module} of all subcommands, by name."""
    names = sorted(
        module.name
        for module in pkgutil.iter_modules(__path__)
        if not module.name.startswith("_")
    )
    return {
        name.replace("_", "-"): importlib.import_module(f"{__name__}.{name}")
        for name in names
    }


def make_parser() -> argparse.ArgumentParser:
    """Return the parser of the whole command line."""
    parser = Parser(
        prog="cg2raw", description="CG images as the RAW of a chosen sensor."
    )
    parser.add_argument("--version", action="version", version=f"cg2raw {__version__}")
    parser.add_argument(
        "--print-completion",
        action=PrintCompletion,
        choices=SHELLS,
        help="print the completion of a shell, which it evaluates",
    )
    choices = parser.add_subparsers(metavar="COMMAND", required=True)
    for name, module in subcommands().items():
        first, _, rest = (module.__doc__ or "").partition("\n")
        command = choices.add_parser(
            name,
            help=first.rstrip("."),
            description=first + rest,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        module.add_arguments(command)
        command.set_defaults(run=module.run, name=name)
    return parser


def tell(arguments: argparse.Namespace, sentence: str) -> None:
    """Print why a command ends; of --help there is no command."""
    name = f"cg2raw {getattr(arguments, 'name', '')}".rstrip()
    print(f"{name}: {sentence}", file=sys.stderr)


def drop_what_is_not_printed() -> None:
    """Drop output that nobody takes, or no disk: else the interpreter tries once more
    at its end, says so, and exits with 120."""
    try:
        sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command line (default: sys.argv); return its exit code."""
    arguments = argparse.Namespace()
    if isinstance(sys.stdout, io.TextIOWrapper):  # names of files may be no Unicode
        sys.stdout.reconfigure(errors="backslashreplace")
    try:
        words = sys.argv[1:] if argv is None else argv
        arguments = make_parser().parse_args(with_ranges(with_command(words)))
        check_words(words)
        code: int = arguments.run(arguments)
        sys.stdout.flush()
        return code
    except BrokenPipeError:
        drop_what_is_not_printed()  # whoever read our output has seen enough
        return 1
    except (ValueError, OSError, MemoryError) as error:
        tell(arguments, about_output(arguments, error))
        drop_what_is_not_printed()
        return 1
    except KeyboardInterrupt:
        tell(arguments, "interrupted")
        return 130

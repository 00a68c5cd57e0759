# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""docs/man: a manual page of cg2raw and of each of its commands, from their parsers."""

import argparse
import re
from collections.abc import Iterator
from pathlib import Path

from cg2raw import __version__
from cg2raw.cli import make_parser

FOLDER = "docs/man"
LICENCE = '.\\" SPDX-License-Identifier: Apache-2.0\n.\\" Copyright Contributors to'
HEAD = LICENCE + ' the cg2raw Project.\n.\\" scripts/generate.py writes this page.\n'
NOT_OPTIONS = ("positional arguments", "options")  # titles that argparse itself gives


def escaped(text: str) -> str:
    """Return text as roff prints it."""
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\n".join(
        "\\&" + line if line[:1] in (".", "'") else line for line in text.split("\n")
    )


def commands_of(parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """Return {words: parser} of the commands of a parser, and of theirs."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            found = dict(action.choices)
            for name, command in action.choices.items():
                inner = commands_of(command)
                found |= {f"{name} {word}": one for word, one in inner.items()}
            return found
    return {}


def values_of(action: argparse.Action) -> str:
    """Return how the values of an argument are written, empty if it has none."""
    if action.nargs == 0:
        return ""
    name = action.metavar or action.dest.upper()
    if action.choices is not None and not action.metavar:
        name = "{" + ",".join(map(str, action.choices)) + "}"
    many = {"+": f"{name} [{name} ...]", "*": f"[{name} ...]", "?": f"[{name}]"}
    if isinstance(action.nargs, int):
        return " ".join([str(name)] * action.nargs)
    return many.get(str(action.nargs), str(name))


def synopsis(name: str, parser: argparse.ArgumentParser) -> str:
    """Return the line of a command: what it needs, and that there are options."""
    words, places = ["[options]"], []
    for action in parser._actions:
        if action.option_strings and action.required:
            words.append(f"{action.option_strings[0]} {values_of(action)}")
        elif not action.option_strings:
            places.append(values_of(action))
    return f".B {escaped(name)}\n{escaped(' '.join(words + places))}\n"


def paragraphs(text: str) -> Iterator[str]:
    """Yield paragraphs: filled, or as they stand where their first line is indented."""
    for part in re.split(r"\n\s*\n", text.strip("\n")):
        if part.startswith(" "):
            yield f".PP\n.nf\n{escaped(part)}\n.fi\n"
        else:
            yield f".PP\n{escaped(part)}\n"


def argument(action: argparse.Action, formatter: argparse.HelpFormatter) -> str:
    """Return the entry of an option or a place."""
    value = escaped(values_of(action))
    names = ", ".join(f"\\fB{escaped(name)}\\fR" for name in action.option_strings)
    shown = f"{names} \\fI{value}\\fR" if names and value else names or f"\\fI{value}"
    help = escaped(formatter._expand_help(action)) if action.help else ""
    return f".TP\n{shown}\\fR\n{help}\n".replace("\\fR\\fR", "\\fR")


def options(parser: argparse.ArgumentParser) -> str:
    """Return the section of all arguments, by their groups."""
    formatter, text = parser._get_formatter(), ".SH OPTIONS\n"
    for group in parser._action_groups:
        listed = [
            action
            for action in group._group_actions
            if action.help is not argparse.SUPPRESS
            and not isinstance(action, argparse._SubParsersAction)
        ]
        if listed and group.title not in NOT_OPTIONS:
            text += f".SS {escaped(str(group.title))}\n"
        text += "".join(argument(action, formatter) for action in listed)
    return text


def page_of(name: str) -> str:
    """Return what the page of a command is called."""
    return "\\-".join(["cg2raw", *name.split()])


def title(name: str) -> str:
    """Return the first lines of a page."""
    return f'{HEAD}.TH {name.upper()} 1 "" "cg2raw {__version__}" "User Commands"\n'


def commands_section(
    commands: dict[str, argparse.ArgumentParser], before: str = ""
) -> str:
    """Return the section that lists commands, if there are any."""
    text = ".SH COMMANDS\n" if commands else ""
    for name, command in commands.items():
        first = (command.description or "").partition("\n")[0]
        text += f".TP\n.BR {page_of(before + name)} (1)\n{escaped(first)}\n"
    return text


def command_page(name: str, parser: argparse.ArgumentParser) -> str:
    """Return the page of one command."""
    whole = parser.description or ""
    first, _, rest = whole.partition("\n")
    rest, _, examples = rest.partition("examples:\n")
    page = title(page_of(name))
    page += f".SH NAME\n{page_of(name)} \\- {escaped(first.rstrip('.'))}\n"
    page += f".SH SYNOPSIS\n{synopsis(f'cg2raw {name}', parser)}"
    if rest.strip():
        page += ".SH DESCRIPTION\n" + "".join(paragraphs(rest))
    page += commands_section(commands_of(parser), f"{name} ") + options(parser)
    if examples:
        page += f".SH EXAMPLES\n.nf\n{escaped(examples.rstrip())}\n.fi\n"
    return page + ".SH SEE ALSO\n.BR cg2raw (1)\n"


def main_page(
    parser: argparse.ArgumentParser, commands: dict[str, argparse.ArgumentParser]
) -> str:
    """Return the page of cg2raw itself, which lists its commands."""
    page = title("cg2raw")
    summary = escaped((parser.description or "").rstrip("."))
    page += f".SH NAME\ncg2raw \\- {summary}\n"
    page += ".SH SYNOPSIS\n.B cg2raw\nCOMMAND [options] ...\n"
    return page + commands_section(commands) + options(parser)


def texts(root: Path) -> dict[str, str | None]:
    """Return {path: text} of what is written below a root; None of what goes."""
    parser = make_parser()
    commands = commands_of(parser)
    found = (root / FOLDER).glob("*.1")
    made = dict.fromkeys(path.relative_to(root).as_posix() for path in found)
    for name, command in commands.items():
        made[f"{FOLDER}/cg2raw-{name.replace(' ', '-')}.1"] = command_page(
            name, command
        )
    return made | {f"{FOLDER}/cg2raw.1": main_page(parser, commands)}

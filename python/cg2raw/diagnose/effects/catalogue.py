# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Catalogue: the effects of this folder's files, and which of them can be named."""

from collections.abc import Collection, Iterable, Mapping
from functools import cache
from importlib import import_module
from pkgutil import iter_modules

from cg2raw import _core
from cg2raw.cfa import is_mono, sites_of
from cg2raw.diagnose import effects as folder
from cg2raw.diagnose.effects.base import Effect
from cg2raw.diagnose.effects.registry import registered


@cache
def every() -> Mapping[str, Effect]:
    """Return all effects by name, in the order of the registry.

    A file that has an EFFECT is one. Raises ValueError if the registry and the files
    do not have the same names."""
    modules = [
        import_module(f"{folder.__name__}.{module.name}")
        for module in iter_modules(folder.__path__)
        if module.name != "catalogue"
    ]
    found = {m.EFFECT.name: m.EFFECT for m in modules if hasattr(m, "EFFECT")}
    if missing := sorted(set(registered()) - set(found)):
        raise ValueError(
            f'the registry has the effect "{missing[0]}", and {folder.__name__} has no '
            f"file for it: add {missing[0]}.py with its EFFECT"
        )
    if unknown := sorted(set(found) - set(registered())):
        raise ValueError(
            f'{folder.__name__} has the effect "{unknown[0]}", and the registry has '
            f"not: add plugins/effects/{unknown[0]}.cpp and build"
        )
    return {name: found[name] for name in registered()}


def effect(name: str) -> Effect:
    """Return an effect by its name."""
    return every()[name]


def names() -> list[str]:
    """Return the names of all effects that can be named."""
    return [one.name for one in every().values() if one.nameable]


@cache
def of_images() -> frozenset[str]:
    """Return the names of the effects that images tell apart where flats do not."""
    return frozenset(name for name in names() if effect(name).of_images)


@cache
def of_means() -> frozenset[str]:
    """Return the names of the effects that move the mean of images."""
    return frozenset(name for name in names() if effect(name).predicted)


def misfit_sources(
    name: str,
    nats: Mapping[str, float],
    alike: Mapping[str, Collection[str]],
    least: float = 0.0,
) -> list[str]:
    """Return the effects whose misfit @name may be: what their models do not describe.

    nats : that each effect gains. alike : others that may be in its place. least : the
    share of a gain that any may leave."""
    return [
        other
        for other, gain in nats.items()
        for one in (other, *alike.get(other, ()))
        if nats[name] < max(effect(one).taken_up_by.get(name, 0.0), least) * gain
    ]


def candidates(cfa: str, without: Iterable[str] = ()) -> list[Effect]:
    """Return the effects that can be named for a CFA, as it has them, but for some.

    Raises ValueError for a name that is none."""
    for name in without:
        if (new := _core.current_effect_name(name)) != name:
            raise ValueError(f'effect "{name}" is called "{new}" since version 0.1')
        if name not in names():
            raise ValueError(
                f'effect "{name}" cannot be left out, since no diagnosis names it: '
                f"known are {', '.join(names())}"
            )
    return [
        one.of_cfa(cfa)
        for one in every().values()
        if one.nameable and one.name not in set(without) and _exists(one, cfa)
    ]


def _exists(effect: Effect, cfa: str) -> bool:
    """Return whether sensors of a CFA can have an effect."""
    if is_mono(cfa):
        return effect.name in registered(cfa)
    return len(sites_of(cfa)) == 4 or not effect.bayer_only


def title(name: str) -> str:
    """Return an effect's display name; of any other name, its words."""
    known = every().get(name)
    return known.title if known else name.replace("_", " ")


def heading(name: str) -> str:
    """Return an effect's display name as a sentence begins."""
    words = title(name)
    return words[:1].upper() + words[1:]

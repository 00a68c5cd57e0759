# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Makes Mitsuba's dictionary of a scene. Needs mitsuba, and nothing of cg2raw."""

from typing import Any

import mitsuba

FIRST, LAST = 380.0, 780.0  # nm, of all spectra, in equal steps
DEPTH, ROULETTE = 4, 4  # segments of a path; from where on it may end by chance
BLOCK = 32  # pixels; set, for a block's random numbers must not depend on threads
LEAST_WEIGHT = 0.1  # of a light when paths choose one, of the mean light's
CHOICE = 0.75  # power of the flux of a light, as often as which paths choose it
LIGHT_SHARE = 0.7  # of the wavelengths: drawn by the scene's light as cameras see it
SKY_AREA = 2000.0  # m2 of lamps of its radiance that the sky is chosen as often as

Json = dict[str, Any]


def curve(values: list[float], scale: float = 1.0) -> Json:
    """Return Mitsuba's spectrum of values from FIRST to LAST."""
    return {
        "type": "regular",
        "wavelength_min": FIRST,
        "wavelength_max": LAST,
        "values": ", ".join(f"{value * scale:.7g}" for value in values),
    }


def surface(material: Json) -> Json:
    """Return the BSDF of a material, both of whose sides are alike."""
    reflectance, finish = curve(material["reflectance"]), material["finish"]
    made: Json
    if finish == "metal":
        made = {
            "type": "roughconductor",
            "material": "none",
            "specular_reflectance": reflectance,
            "alpha": material["roughness"],
        }
    elif finish == "gloss":
        made = {
            "type": "roughplastic",
            "diffuse_reflectance": reflectance,
            "alpha": material["roughness"],
        }
    else:
        made = {"type": "diffuse", "reflectance": reflectance}
    return {"type": "twosided", "surface": made}


def shape(thing: Json) -> Json:
    """Return Mitsuba's shape of a thing, without its surface."""
    transform = mitsuba.ScalarTransform4f
    place, size = thing["place"], thing["size"]
    if thing["shape"] == "ball":
        return {"type": "sphere", "center": place, "radius": size[0]}
    if thing["shape"] == "rod":
        end = [place[0], place[1] + size[1], place[2]]
        return {"type": "cylinder", "p0": place, "p1": end, "radius": size[0]}
    turned = transform().translate(place).rotate([0, 1, 0], thing["turn"])
    half = [value / 2.0 for value in size]
    if thing["shape"] == "panel":
        return {"type": "rectangle", "to_world": turned.scale([*half, 1.0])}
    return {"type": "cube", "to_world": turned.scale(half)}


def area(thing: Json) -> float:
    """Return roughly how large a thing is, m2: products of its sizes."""
    size = sorted(thing["size"])
    return float(size[-1] * size[-2]) if len(size) > 1 else float(4.0 * size[0] ** 2)


def weights(things: list[Json], sky: Json) -> tuple[list[float], float]:
    """Return how often paths choose each thing as a light, and the sky: a power of
    their flux below 1, for what is dim is near to something."""
    found = [(thing["level"] * area(thing)) ** CHOICE for thing in things]
    shining = [value for value in found if value > 0.0]
    least = LEAST_WEIGHT * sum(shining) / max(len(shining), 1)
    above = (sky["level"] * SKY_AREA) ** CHOICE
    return [max(value, least) for value in found], max(above, least)


def film(frame: Json, light: list[float]) -> Json:
    """Return a film of a channel for each sensitivity: an integral over wavelengths.

    A last channel is of no camera. Mitsuba draws wavelengths in proportion to the sum
    of all channels: this one makes them those at which most of the scene's light is
    seen, without which lamps of few lines are all grain."""
    channels = frame["channels"]
    seen = [sum(column) for column in zip(*channels, strict=True)]
    both = [a * b for a, b in zip(seen, light, strict=True)]
    scale = LIGHT_SHARE / (1.0 - LIGHT_SHARE) * sum(seen) / sum(both)
    channels = [*channels, [scale * value for value in both]]
    bands = {f"c{number:03}": curve(values) for number, values in enumerate(channels)}
    return {
        "type": "specfilm",
        "width": frame["width"],
        "height": frame["height"],
        "component_format": "float32",
        "rfilter": {"type": "box"},
        **bands,
    }


def camera(view: Json, frame: Json, light: list[float]) -> Json:
    """Return the camera of a view; light : (81,), of the whole scene."""
    look = mitsuba.ScalarTransform4f().look_at(
        view["origin"], view["target"], [0, 1, 0]
    )
    return {
        "type": "perspective",
        "fov": view["field"],
        "to_world": look,
        "film": film(frame, light),
        "sampler": {"type": "multijitter", "sample_count": frame["samples"]},
    }


def built(asked: Json) -> Json:
    """Return the dictionary of a scene as studies.mitsuba_judge.scene describes it.

    asked : scene and film: width, height, samples a pixel, channels (n, 81)."""
    scene = asked["scene"]
    things, sky, lights = scene["things"], scene["sky"], scene["lights"]
    chosen, above = weights(things, sky)
    made: Json = {
        "type": "scene",
        "integrator": {
            "type": "path",
            "max_depth": DEPTH,
            "rr_depth": ROULETTE,
            "block_size": BLOCK,
        },
        "camera": camera(scene["view"], asked["film"], scene["mean_light"]),
    }
    if sky["level"] > 0.0:
        made["sky"] = {
            "type": "constant",
            "radiance": curve(lights[sky["light"]], sky["level"]),
            "sampling_weight": above,
        }
    for number, material in enumerate(scene["materials"]):
        made[f"material{number:03}"] = surface(material)
    for number, (thing, weight) in enumerate(zip(things, chosen, strict=True)):
        each = shape(thing)
        if thing["light"] is None:
            each["surface"] = {"type": "ref", "id": f"material{thing['material']:03}"}
        else:
            each["light"] = {
                "type": "area",
                "radiance": curve(lights[thing["light"]], thing["level"]),
                "sampling_weight": weight,
            }
        made[f"thing{number:04}"] = each
    return made

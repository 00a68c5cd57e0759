# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A box with a ColorChecker and two spheres for Mitsuba 3, in spectra or in RGB.

Walls and spheres have reflectances of PhotoResearch, the chart those of ISO 17321-1, as
colour-science has them; all are diffuse. A lamp above the camera's view lights them."""

import numpy as np

from cg2raw.profile.illuminant_spectra import illuminant_spectrum
from cg2raw.profile.spectral_file import WAVELENGTHS
from oracles import spectral

FIRST, LAST, STEP = 390, 710, 10  # nm: edges of the film's bands
CENTRES = np.arange(FIRST + STEP / 2, LAST, STEP)
SIZE = (240, 160)  # width, height
DEPTH = 6  # segments of a path
LAMP = 12.0  # radiance of the lamp over that of white at saturation
WALLS = {"left": "Unitary red", "right": "Unitary green", "rest": "White"}
SPHERES = {"near": "Orange Yellow", "far": "Unitary blue"}


def measured(name):
    """Return the reflectance (81,) of PhotoResearch's sample."""
    samples = list(spectral.colour.SDS_COLOURCHECKERS["PMC"])
    return spectral.held_out()["PMC"][samples.index(name)]


def curve(values):
    """Return Mitsuba's spectrum of values (81,) at WAVELENGTHS."""
    return {
        "type": "regular",
        "wavelength_min": float(WAVELENGTHS[0]),
        "wavelength_max": float(WAVELENGTHS[-1]),
        "values": ", ".join(f"{value:.6g}" for value in values),
    }


class Spectra:
    """The scene's quantities as spectra."""

    variant = "scalar_spectral"

    def __init__(self, light):
        self.light = curve(LAMP * illuminant_spectrum(light))

    def reflectance(self, values):
        return curve(values)

    def film(self):
        """Return the film of bands whose values are integrals over STEP."""
        bands = {
            f"b{nm:03.0f}": {
                "type": "regular",
                "wavelength_min": nm - STEP / 2,
                "wavelength_max": nm + STEP / 2,
                "values": "1, 1",
            }
            for nm in CENTRES
        }
        return {"type": "specfilm", "component_format": "float32", **bands}


class Rec709:
    """The scene's quantities as linear Rec.709: white light, colours under D65.

    Mitsuba takes reflectances of 0 to 1 only: negative components become 0."""

    variant = "scalar_rgb"

    def __init__(self, light):
        self.light = {"type": "rgb", "value": [LAMP] * 3}

    def reflectance(self, values):
        # Two rows, for xyz returns a vector for one.
        rgb = spectral.rec709_under_d65(np.array([values, values]))[0]
        return {"type": "rgb", "value": np.clip(rgb, 0.0, 1.0).tolist()}

    def film(self):
        return {
            "type": "hdrfilm",
            "pixel_format": "rgb",
            "component_format": "float32",
        }


def rectangle(mi, of, centre, size, turn=(), values=None):
    """Return a rectangle that faces +z before its turns [(axis, degrees)]."""
    place = mi.ScalarTransform4f().translate(centre)
    for axis, angle in turn:
        place = place.rotate(axis, angle)
    shape = {
        "type": "rectangle",
        "to_world": place.scale([size[0] / 2, size[1] / 2, 1.0]),
    }
    if values is not None:
        shape["bsdf"] = {"type": "diffuse", "reflectance": of.reflectance(values)}
    return shape


def room(mi, of):
    """Return the walls, 3 wide, 2 high and 4 deep, and the lamp."""
    x, y = [1, 0, 0], [0, 1, 0]
    rest = measured(WALLS["rest"])
    lamp = rectangle(mi, of, [0, 1.99, 0.6], (1.6, 0.8), [(x, 90)])
    lamp["emitter"] = {"type": "area", "radiance": of.light}
    return {
        "floor": rectangle(mi, of, [0, 0, 0], (3, 4), [(x, -90)], rest),
        "ceiling": rectangle(mi, of, [0, 2, 0], (3, 4), [(x, 90)], rest),
        "back": rectangle(mi, of, [0, 1, -2], (3, 2), [], rest),
        "left": rectangle(
            mi, of, [-1.5, 1, 0], (4, 2), [(y, 90)], measured(WALLS["left"])
        ),
        "right": rectangle(
            mi, of, [1.5, 1, 0], (4, 2), [(y, -90)], measured(WALLS["right"])
        ),
        "lamp": lamp,
    }


def chart(mi, of):
    """Return the ColorChecker's 24 patches on a black panel at the back wall."""
    side, pitch = 0.25, 0.28
    patches = spectral.held_out()["ColorChecker"]
    shapes = {
        "panel": rectangle(mi, of, [0, 1.1, -1.9], (1.75, 1.2), [], patches[23]),
    }
    for i, values in enumerate(patches):
        row, column = divmod(i, 6)
        centre = [(column - 2.5) * pitch, 1.1 - (row - 1.5) * pitch, -1.89]
        shapes[f"patch{i:02}"] = rectangle(mi, of, centre, (side, side), [], values)
    return shapes


def sphere(of, name, centre, radius):
    """Return a diffuse sphere of one of SPHERES."""
    colour = of.reflectance(measured(SPHERES[name]))
    return {
        "type": "sphere",
        "center": centre,
        "radius": radius,
        "bsdf": {"type": "diffuse", "reflectance": colour},
    }


def scene(mi, of, samples):
    """Return the scene's dictionary for a renderer whose variant is that of @of.

    samples : of a pixel. Multi-jittered ones spread over the wavelengths, too."""
    width, height = SIZE
    look = {"origin": [0, 1.0, 3.4], "target": [0, 0.95, -2], "up": [0, 1, 0]}
    return {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": DEPTH, "rr_depth": 50},
        "camera": {
            "type": "perspective",
            "fov": 38.0,
            "fov_axis": "x",
            "to_world": mi.ScalarTransform4f().look_at(**look),
            "sampler": {"type": "multijitter", "sample_count": samples},
            "film": {
                "width": width,
                "height": height,
                "rfilter": {"type": "box"},
                **of.film(),
            },
        },
        **room(mi, of),
        **chart(mi, of),
        "near": sphere(of, "near", [0.72, 0.35, -0.3], 0.35),
        "far": sphere(of, "far", [-0.75, 0.4, -0.7], 0.4),
    }


def render(mi, of, samples, seed):
    """Return the (H, W, channels) float32 render: W/(m2 sr nm) by band, or RGB.

    RGB of 1 and the light's spectrum at LAMP's unit are the same white."""
    mi.set_variant(of.variant)
    image = np.array(mi.render(mi.load_dict(scene(mi, of, samples)), seed=seed))
    return image / STEP if isinstance(of, Spectra) else image

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Facts of images without files, for the core's rules of them."""

from cg2raw import _core
from cg2raw.io import image_file

DIALECT = _core.Dialect(
    image_file.typed, lambda word: True, "lin_rec709", "--iscolorspace lin_rec709"
)


def facts(parts, stated=None, samples="half", version=30202):
    """Return the facts of (name, channels) parts that all state the same."""
    images = [(name, list(c), samples, True, stated or {}) for name, c in parts]
    return _core.ImageFacts(images, "", "", version)


def picture(of_image, undo="none", dialect=DIALECT):
    """Return what is decided of a picture."""
    options = _core.ExportOptions({}, dialect, undo)
    return _core.resolve_picture(of_image, options, dialect)


def picture_layer(parts, asked="", stated=None):
    """Return the layer of parts that is the picture."""
    options = _core.ExportOptions({"layer": asked}, DIALECT)
    return _core.picture_layer(facts(parts, stated), options, DIALECT)


def spectral_bins(names, wavelengths=None, responses=None):
    """Return the bins among channels; wavelengths : {channel: m}."""
    stated = {f"{name}.wavelength": (m,) for name, m in (wavelengths or {}).items()}
    return _core.spectral_bins(facts([("", names)], stated | (responses or {})))

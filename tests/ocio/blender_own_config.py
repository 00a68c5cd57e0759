# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Pictures saved by Blender through its view and as RAW, for test_blender.py.

Runs in Blender: blender_own_config.py folder, or
blender_own_config.py look OUT.png PIXELS.npy [OUT.exr SPACE]. Prints a line of JSON."""

import json
import sys

import bpy
import numpy as np


def image_of(pixels):
    """Return Blender's float image of (h, w, 3)."""
    height, width, _ = pixels.shape
    image = bpy.data.images.new("scene", width, height, float_buffer=True)
    rgba = np.concatenate([pixels, np.ones((height, width, 1), np.float32)], 2)
    image.pixels.foreach_set(rgba[::-1].ravel())  # from the lowest row up
    return image


def save(image, path, space=None):
    """Save a PNG through the scene's view, or a float EXR in a space."""
    settings = bpy.context.scene.render.image_settings
    settings.file_format = "OPEN_EXR" if space else "PNG"
    settings.color_mode = "RGB"
    if space:
        settings.color_depth, settings.color_management = "32", "OVERRIDE"
        settings.linear_colorspace_settings.name = space
    image.save_render(path, scene=bpy.context.scene)


def main(action, *arguments):
    """Print what was asked for."""
    if action == "folder":
        folder = bpy.utils.system_resource("DATAFILES", path="colormanagement")
        print("JSON", json.dumps({"folder": folder}))
        return
    look, pixels, *raw = arguments
    image = image_of(np.load(pixels))
    save(image, look)
    if raw:
        save(image, *raw)
    view = bpy.context.scene.view_settings.view_transform
    print("JSON", json.dumps({"view": view}))


main(*(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]))

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Blender renders a scene, and a camera's RAW file comes out.

    source scripts/env
    blender -b -P ocio/examples/blender_raw.py -- shot.dng

or `python ocio/examples/blender_raw.py shot.dng` where `import bpy` works (Blender 5).
After the file may follow SENSOR ILLUMINANT WIDTH SAMPLES (nikon-d40 D65 640 32).
Writes shot.exr, the render in the RAW space of that sensor, and shot.dng. Blender
reads the RAW spaces from the config that OCIO names."""

import math
import subprocess
import sys
from pathlib import Path

import bpy

# 8-bit sRGB of the 24 patches. Source: X-Rite, ColorChecker Classic, nominal values.
CHART = """
735244 c29682 627a9d 576c43 8580b1 67bdaa d67e2c 505ba6 c15a63 5e3c6c 9dbc40 e0a32e
383d96 469449 af363c e7c71f bb5695 0885a1 f3f3f2 c8c8c8 a0a0a0 7a7a79 555555 343434
"""


def linear(code):
    """Return 0..1 linear of an 8-bit sRGB code. Source: IEC 61966-2-1."""
    value = code / 255
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


def paint(thing, color, **inputs):
    """Give @thing a material of linear @color; @inputs of the Principled shader."""
    material = bpy.data.materials.new(thing.name)
    if material.node_tree is None:  # before Blender 5
        material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*color, 1.0)
    for name, value in {"Roughness": 0.9, "Specular IOR Level": 0.0, **inputs}.items():
        shader.inputs[name].default_value = value
    thing.data.materials.append(material)


def add(shape, color, location, inputs=None, **size):
    """Add a painted mesh: @shape is the end of the name of its operator."""
    getattr(bpy.ops.mesh, f"primitive_{shape}_add")(location=location, **size)
    paint(bpy.context.object, color, **(inputs or {}))
    return bpy.context.object


def add_chart(corner, pitch=0.36):
    """Add a chart of 6 x 4 patches that stands at @corner and faces the camera."""
    x, y, z = corner
    middle = (x + 2.5 * pitch, y + 0.04, z - 1.5 * pitch)
    board = add("cube", (0.02, 0.02, 0.02), middle, size=1)
    board.scale = (6.3 * pitch, 0.06, 4.3 * pitch)
    for i, code in enumerate(CHART.split()):
        color = [linear(byte) for byte in bytes.fromhex(code)]
        where = (x + i % 6 * pitch, y, z - i // 6 * pitch)
        patch = add("plane", color, where, size=0.85 * pitch)
        patch.rotation_euler.x = math.pi / 2


def build_scene():
    """Lit objects: the light is white, for its colour is the RAW space's illuminant."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    add("plane", (0.35, 0.35, 0.35), (0, 0, 0), size=40)
    add("plane", (0.3, 0.32, 0.36), (0, 4, 0), size=40).rotation_euler.x = math.pi / 2
    add_chart((-2.1, 0.6, 1.5))
    ball = dict(segments=64, ring_count=32)
    mirror = {"Metallic": 1.0, "Roughness": 0.08, "Specular IOR Level": 0.5}
    gloss = {"Roughness": 0.2, "Specular IOR Level": 0.5}
    add("uv_sphere", (0.9, 0.7, 0.3), (1.1, 0.9, 0.7), mirror, radius=0.7, **ball)
    add("uv_sphere", (0.6, 0.03, 0.02), (1.9, -0.5, 0.35), gloss, radius=0.35, **ball)
    add("uv_sphere", (0.02, 0.06, 0.5), (0.7, -0.6, 0.3), gloss, radius=0.3, **ball)
    lamp = {"Emission Color": (1, 1, 1, 1), "Emission Strength": 6.0}
    add("uv_sphere", (1, 1, 1), (2.2, 1.8, 1.6), lamp, radius=0.25, **ball)
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.data.angle = 3.6, math.radians(6)
    sun.rotation_euler = (math.radians(50), 0, math.radians(-30))
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (0.2, -7, 1.6), (math.radians(85), 0, 0)
    camera.data.lens = 45
    for thing in (sun, camera):
        scene.collection.objects.link(thing)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("world")
    scene.world.color = (0.25, 0.25, 0.25)
    return scene


def render(scene, space, path, width, samples):
    """Render to a float EXR in the colour space @space."""
    scene.render.engine, scene.cycles.samples = "CYCLES", samples
    scene.cycles.use_denoising = True  # noise is for the sensor to add
    scene.render.resolution_x, scene.render.resolution_y = width, width * 3 // 4
    image = scene.render.image_settings
    image.file_format, image.color_depth, image.color_mode = "OPEN_EXR", "32", "RGB"
    image.color_management = "OVERRIDE"
    image.linear_colorspace_settings.name = space
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def main(dng, sensor="nikon-d40", illuminant="D65", width=640, samples=32):
    """Render the scene and write @dng and, beside it, the EXR that it is made of."""
    space, dng = f"RAW - {sensor} - {illuminant}", Path(dng).resolve()
    exr = dng.with_suffix(".exr")
    render(build_scene(), space, exr, int(width), int(samples))
    is_raw = ["--iscolorspace", space]  # the EXR does not say so itself
    subprocess.run(["oiiotool", exr, *is_raw, "-o", dng], check=True)


if __name__ == "__main__":
    main(*sys.argv[sys.argv.index("--") + 1 if "--" in sys.argv else 1 :])

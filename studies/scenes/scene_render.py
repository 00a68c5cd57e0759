# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Camera, lights and the half float EXR of the test scenes (Blender Cycles, CPU)."""

import argparse
import math
import os

import bpy
import scene_materials as materials
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector

INDIRECT_CLAMP = 12.0  # scene linear; keeps fireflies out, direct light is untouched


def arguments(description, samples, width):
    """Parse OUT.exr [--samples N] [--width W]."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("output", metavar="OUT.exr")
    parser.add_argument("--samples", type=int, default=samples, help="paths per pixel")
    parser.add_argument("--width", type=int, default=width, help="pixels")
    return parser.parse_args()


def begin():
    """Start from an empty scene rendered by Cycles."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    return scene


def aim(item, target):
    """Turn @p item so that its -z axis points at @p target."""
    direction = Vector(target) - item.location
    item.rotation_euler = direction.to_track_quat("-Z", "Y").to_euler()


def camera(location, target, focal_length, shift_y=0.0, focus=None, f_number=8.0):
    """Add the camera: focal length in mm on 36 mm, shift in picture widths."""
    data = bpy.data.cameras.new("camera")
    data.lens = focal_length
    data.shift_y = shift_y
    item = bpy.data.objects.new("camera", data)
    item.location = location
    aim(item, target)
    if focus is not None:
        data.dof.use_dof = True
        data.dof.focus_distance = (Vector(focus) - item.location).length
        data.dof.aperture_fstop = f_number
    bpy.context.scene.collection.objects.link(item)
    bpy.context.scene.camera = item
    return item


def light(kind, location, power, kelvin=None, color=None, target=None, **settings):
    """Add a POINT, SPOT or AREA light in W, or a SUN in W/m^2, by kelvin or colour."""
    data = bpy.data.lights.new(kind.lower(), kind)
    data.energy = power
    if kelvin is not None:
        data.use_temperature = True
        data.temperature = kelvin
    if color is not None:
        data.color = color
    for key, value in settings.items():
        setattr(data, key, value)
    item = bpy.data.objects.new(data.name, data)
    item.location = location
    if target is not None:
        aim(item, target)
    bpy.context.scene.collection.objects.link(item)
    return item


def sky(horizon, zenith, ground, cloud=None):
    """Fill the world with a gradient of radiances, with clouds of radiance @p cloud."""
    nodes = materials.Nodes(bpy.context.scene.world.node_tree)
    ray = nodes.add("TexCoord").outputs["Generated"]
    height = nodes.add("SeparateXYZ", {0: ray}).outputs[2]
    up = nodes.remap(height, 0.0, 0.6)
    color = nodes.mix(up, horizon, zenith)
    if cloud is not None:
        cover = nodes.remap(nodes.noise(ray, 4.5, 8.0, 0.6, 0.3), 0.5, 0.68)
        color = nodes.mix(cover, color, cloud)
    below = nodes.remap(height, -0.01, 0.01)
    color = nodes.mix(below, ground, color)
    nodes.output(nodes.add("Background", {"Color": color}).outputs[0], "World")


def quality(scene, samples, diffuse_bounces):
    """Set paths per pixel, bounces and the OpenImageDenoise pass."""
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = samples
    cycles.use_adaptive_sampling = True
    cycles.adaptive_threshold = 0.03
    cycles.adaptive_min_samples = min(samples, 24)
    cycles.sample_clamp_indirect = INDIRECT_CLAMP
    cycles.blur_glossy = 0.3
    cycles.caustics_reflective = False
    cycles.caustics_refractive = False
    cycles.max_bounces = 10
    cycles.diffuse_bounces = diffuse_bounces
    cycles.glossy_bounces = 4
    cycles.transmission_bounces = 10
    cycles.transparent_max_bounces = 16
    cycles.use_denoising = True
    cycles.denoiser = "OPENIMAGEDENOISE"
    cycles.denoising_input_passes = "RGB_ALBEDO_NORMAL"
    cycles.denoising_prefilter = "ACCURATE"
    cycles.seed = 1


def exr(scene, path):
    """Write three half float channels, scene linear Rec.709, DWAA, no stamps."""
    render = scene.render
    render.filepath = os.path.abspath(path)
    render.use_file_extension = False
    for name in dir(render):
        if name.startswith("use_stamp"):
            setattr(render, name, False)
    image = render.image_settings
    image.media_type = "IMAGE"
    image.file_format = "OPEN_EXR"
    image.color_mode = "RGB"
    image.color_depth = "16"
    image.exr_codec = "DWAA"
    image.quality = 90  # DWA level 45, the usual one
    scene.view_settings.view_transform = "Raw"


def run(options, aspect, diffuse_bounces):
    """Render the current scene into options.output; aspect is width over height."""
    scene = bpy.context.scene
    scene.render.resolution_x = options.width
    scene.render.resolution_y = round(options.width / aspect)
    scene.render.resolution_percentage = 100
    quality(scene, options.samples, diffuse_bounces)
    exr(scene, options.output)
    bpy.ops.render.render(write_still=True)


def pixel_of(item, point):
    """Return where @p point of @p item is seen, in pixels from the top left."""
    scene = bpy.context.scene
    bpy.context.view_layer.update()
    seen = world_to_camera_view(scene, scene.camera, item.matrix_world @ Vector(point))
    render = scene.render
    return seen.x * render.resolution_x, (1.0 - seen.y) * render.resolution_y


def degrees(*angles):
    """Return angles given in degrees as radians."""
    return tuple(math.radians(angle) for angle in angles)

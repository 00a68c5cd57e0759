# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What a user of Blender does with colour spaces, as a script for test_blender.py.

Runs in Blender: blender_routes.py ACTION FOLDER [SPACE]. Prints a line of JSON."""

import json
import sys
from pathlib import Path

import bpy

SCENE_LINEAR = "Linear Rec.709 (sRGB)"


def write_as(image_format, space=None):
    """Make @image_format a float EXR without alpha, in @space if that is given."""
    image_format.file_format = "OPEN_EXR"
    image_format.color_depth, image_format.color_mode = "32", "RGB"
    if space:
        image_format.color_management = "OVERRIDE"
        image_format.linear_colorspace_settings.name = space


def compositor_of(image):
    """Return (node group, socket of @image) of an empty scene that composites it."""
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = image.size
    scene.render.resolution_percentage = 100
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.collection.objects.link(scene.camera)
    group = bpy.data.node_groups.new("compositor", "CompositorNodeTree")
    scene.compositing_node_group = group
    node = group.nodes.new("CompositorNodeImage")
    node.image = image
    return group, node.outputs["Image"]


def render(group, socket, path):
    """Render the composite @socket to @path."""
    group.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    output = group.nodes.new("NodeGroupOutput")
    group.links.new(socket, output.inputs["Image"])
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def output_override(image, space, path):
    """Output Properties > Color Management > Override."""
    group, socket = compositor_of(image)
    write_as(bpy.context.scene.render.image_settings, space)
    render(group, socket, path)


def convert_node(image, space, path):
    """Convert Colorspace in the compositor; the file is said to be scene linear."""
    group, socket = compositor_of(image)
    node = group.nodes.new("CompositorNodeConvertColorSpace")
    node.from_color_space, node.to_color_space = SCENE_LINEAR, space
    group.links.new(socket, node.inputs[0])
    write_as(bpy.context.scene.render.image_settings)
    render(group, node.outputs[0], path)


def file_output_node(image, space, path):
    """A File Output node with a colour space of its own."""
    group, socket = compositor_of(image)
    node = group.nodes.new("CompositorNodeOutputFile")
    node.directory, node.file_name = str(path.parent), path.stem
    node.format.media_type = "IMAGE"
    write_as(node.format, space)
    node.file_output_items.new("RGBA", "")
    group.links.new(socket, node.inputs[0])
    write_as(bpy.context.scene.render.image_settings)
    render(group, socket, path.with_name("composite.exr"))


def save_render(image, space, path):
    """Image editor > Save As, with a colour space."""
    write_as(bpy.context.scene.render.image_settings, space)
    image.save_render(str(path))


def read_raw(image, space, path):
    """An image of RAW, which Blender takes to the scene."""
    image.colorspace_settings.name = space
    write_as(bpy.context.scene.render.image_settings)
    image.save_render(str(path))


def routes(folder, space):
    """Write scene.exr of @folder along each route to a file of its name."""
    for route in (
        output_override,
        convert_node,
        file_output_node,
        save_render,
        read_raw,
    ):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        image = bpy.data.images.load(str(folder / "scene.exr"))
        route(image, space, folder / f"{route.__name__}.exr")


def spaces(folder):
    """Return the menus of colour spaces and what Blender makes of the roles."""
    image = bpy.data.images.new("float", 4, 4, float_buffer=True)
    menu = image.colorspace_settings.bl_rna.properties["name"].enum_items
    data = bpy.data.images.new("data", 4, 4, is_data=True).colorspace_settings
    byte = bpy.data.images.new("byte", 4, 4).colorspace_settings
    scene = bpy.context.scene
    return {
        "menu": [item.identifier for item in menu],
        "working": bpy.data.colorspace.working_space_interop_id,
        "data": [data.name, data.is_data],
        "byte": byte.name,
        "float": image.colorspace_settings.name,
        "view": scene.view_settings.view_transform,
    }


def save_blend(folder):
    """Save a file whose images have Blender's own names of colour spaces."""
    for name in ("Non-Color", "sRGB", "Linear Rec.709", "ACEScg", "ACES2065-1"):
        image = bpy.data.images.new(name, 2, 2, float_buffer=True)
        image.colorspace_settings.name = name
        image.use_fake_user = True
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "own.blend"))


def open_blend(folder):
    """Return the colour space that each image of that file has now."""
    bpy.ops.wm.open_mainfile(filepath=str(folder / "own.blend"))
    images = [image for image in bpy.data.images if image.source == "GENERATED"]
    return {image.name: image.colorspace_settings.name for image in images}


if __name__ == "__main__":
    action, folder, *space = sys.argv[
        sys.argv.index("--") + 1 if "--" in sys.argv else 1 :
    ]
    actions = {f.__name__: f for f in (routes, spaces, save_blend, open_blend)}
    print("\nJSON", json.dumps(actions[action](Path(folder), *space)))

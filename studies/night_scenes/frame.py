# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Builds one scene and renders it to an EXR file. Needs the module bpy."""

import json
import random

import bpy

from . import interior, square, street, waterfront
from .parts import houses, lamps, people, signs, sky, things, vehicles
from .parts.library import render

ASPECT = 16 / 9
STAGES = {
    "street": street,
    "square": square,
    "waterfront": waterfront,
    "interior": interior,
}
DIFFUSE_BOUNCES = {"street": 2, "square": 2, "waterfront": 2, "interior": 4}


def build(scene):
    """Build @scene, a choices.description.Scene, in an empty Blender scene."""
    render.begin()
    sky.build(scene)
    STAGES[scene.kind].stage(scene)
    houses.rows(scene.rows, random.Random(f"windows {scene.index}"))
    houses.towers(scene.towers)
    lamps.build(scene.lamps)
    lamps.festoons(scene.festoons)
    signs.build(scene.signs)
    vehicles.build(scene.vehicles)
    people.build(scene.people)
    things.build(scene.things)
    view = scene.camera
    render.camera(view.place, view.target, view.focal_length, 0.03)


def note(scene):
    """Say in the file's own attribute "Note" what it shows; the JSON has the rest."""
    settings = bpy.context.scene.render
    settings.metadata_input = "SCENE"
    settings.use_stamp_note = True
    words = {"scene": scene.index, "kind": scene.kind, "layout": scene.layout}
    settings.stamp_note_text = json.dumps(words)


def draw(scene, path, width, samples, threads):
    """Build @scene and write it to @path, @width pixels wide, 16:9, on some threads."""
    build(scene)
    target = bpy.context.scene
    settings = target.render
    settings.resolution_x, settings.resolution_y = width, round(width / ASPECT)
    settings.resolution_percentage = 100
    settings.threads_mode, settings.threads = "FIXED", threads
    render.quality(target, samples, DIFFUSE_BOUNCES[scene.kind])
    render.exr(target, str(path))
    note(scene)  # last: the line before takes all notes away
    bpy.ops.render.render(write_still=True)

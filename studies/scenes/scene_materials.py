# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Procedural materials of the test scenes. Colours are linear Rec.709 reflectances."""

import bpy


class Nodes:
    """A node tree under construction; inputs take constants or sockets."""

    def __init__(self, tree):
        self.tree = tree
        tree.nodes.clear()

    def add(self, kind, inputs=None, **settings):
        """Add ShaderNode<kind>, with its settings and inputs by name or index."""
        node = self.tree.nodes.new("ShaderNode" + kind)
        for key, value in settings.items():
            setattr(node, key, value)
        for key, value in (inputs or {}).items():
            self.plug(node.inputs[key], value)
        return node

    def plug(self, socket, value):
        """Link a socket, or set a constant (three numbers become an opaque colour)."""
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        elif socket.type == "RGBA" and len(value) == 3:
            socket.default_value = (*value, 1.0)
        else:
            socket.default_value = value

    def coordinates(self, scale=(1.0, 1.0, 1.0), space="Object"):
        """Return a position, in metres times @p scale."""
        source = self.add("TexCoord").outputs[space]
        return self.add("Mapping", {"Vector": source, "Scale": scale}).outputs[0]

    def noise(self, vector, scale=1.0, detail=6.0, roughness=0.55, distortion=0.0):
        """Return fractal noise near 0..1 with @p scale features per coordinate unit."""
        return self.add(
            "TexNoise",
            {
                "Vector": vector,
                "Scale": scale,
                "Detail": detail,
                "Roughness": roughness,
                "Distortion": distortion,
            },
        ).outputs[0]

    def ramp(self, value, stops):
        """Map @p value to a colour through (position, colour) stops."""
        node = self.add("ValToRGB", {"Fac": value})
        elements = node.color_ramp.elements
        while len(elements) < len(stops):
            elements.new(1.0)
        for element, (position, color) in zip(elements, stops, strict=True):
            element.position = position
            element.color = (*color, 1.0)
        return node.outputs[0]

    def remap(self, value, low, high, to_low=0.0, to_high=1.0):
        """Map low..high linearly to to_low..to_high, clamped."""
        return self.add(
            "MapRange", {"Value": value, 1: low, 2: high, 3: to_low, 4: to_high}
        ).outputs[0]

    def math(self, operation, a, b=0.0):
        """Return one arithmetic operation of two numbers."""
        return self.add("Math", {0: a, 1: b}, operation=operation).outputs[0]

    def mix(self, fraction, a, b, blend="MIX"):
        """Blend colour @p a towards @p b."""
        return self.add(
            "Mix", {0: fraction, 6: a, 7: b}, data_type="RGBA", blend_type=blend
        ).outputs[2]

    def blend(self, fraction, a, b):
        """Blend shader @p a towards shader @p b."""
        return self.add("MixShader", {0: fraction, 1: a, 2: b}).outputs[0]

    def bump(self, height, distance, strength=1.0):
        """Return the normal of a relief @p distance metres deep."""
        return self.add(
            "Bump", {"Height": height, "Distance": distance, "Strength": strength}
        ).outputs[0]

    def output(self, surface, target="Material"):
        """Make @p surface the result of the tree of a Material or World."""
        self.add("Output" + target, {"Surface": surface})


def begin(name):
    """Return a new material and its empty node tree."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    return material, Nodes(material.node_tree)


def finish(nodes, color, roughness=0.5, normal=None, **inputs):
    """End the tree in a principled surface; inputs are its other sockets."""
    values = {"Base Color": color, "Roughness": roughness}
    values.update({key.replace("_", " "): value for key, value in inputs.items()})
    if normal is not None:
        values["Normal"] = normal
    surface = nodes.add("BsdfPrincipled", values).outputs[0]
    nodes.output(surface)
    return surface


def plain(name, color, roughness=0.5, **inputs):
    """Return a uniform principled material."""
    material, nodes = begin(name)
    finish(nodes, color, roughness, **inputs)
    return material


def matte(name, color):
    """Return an ideal diffuser of reflectance @p color."""
    material, nodes = begin(name)
    nodes.output(nodes.add("BsdfDiffuse", {"Color": color}).outputs[0])
    return material


def metal(name, color, roughness=0.15, wear=0.08):
    """Return a metal whose roughness varies by @p wear in smudges of some cm."""
    material, nodes = begin(name)
    smudge = nodes.noise(nodes.coordinates(), 35.0)
    rough = nodes.remap(smudge, 0.35, 0.75, roughness, roughness + wear)
    finish(nodes, color, rough, Metallic=1.0)
    return material


def glow(name, color, strength, sampled=False):
    """Return an emitter of radiance color * strength; sampled makes it a light."""
    material, nodes = begin(name)
    nodes.output(
        nodes.add("Emission", {"Color": color, "Strength": strength}).outputs[0]
    )
    material.cycles.emission_sampling = "FRONT" if sampled else "NONE"
    return material


def glow_kelvin(name, kelvin, strength):
    """Return a black body emitter at @p kelvin of luminance @p strength."""
    material, nodes = begin(name)
    color = nodes.add("Blackbody", {"Temperature": kelvin}).outputs[0]
    nodes.output(
        nodes.add("Emission", {"Color": color, "Strength": strength}).outputs[0]
    )
    material.cycles.emission_sampling = "NONE"
    return material


def glass(name, tint=(1.0, 1.0, 1.0), roughness=0.0, ior=1.5):
    """Return solid glass whose shadow is tinted light instead of noisy caustics."""
    material, nodes = begin(name)
    body = nodes.add("BsdfGlass", {"Color": tint, "Roughness": roughness, "IOR": ior})
    clear = nodes.add("BsdfTransparent", {"Color": [0.92 * c for c in tint]})
    shadow = nodes.add("LightPath").outputs["Is Shadow Ray"]
    nodes.output(nodes.blend(shadow, body.outputs[0], clear.outputs[0]))
    return material


def pane(name, tint=(0.97, 0.98, 0.97)):
    """Return a thin sheet of glass: straight transmission and Fresnel reflection."""
    material, nodes = begin(name)
    clear = nodes.add("BsdfTransparent", {"Color": tint})
    shine = nodes.add("BsdfGlossy", {"Color": (1, 1, 1), "Roughness": 0.01})
    fresnel = nodes.add("Fresnel", {"IOR": 1.45}).outputs[0]
    nodes.output(nodes.blend(fresnel, clear.outputs[0], shine.outputs[0]))
    return material


def wood(name, dark, light, roughness=0.4, along="x", scale=1.0):
    """Return planed wood with grain and pores along one axis of the object."""
    material, nodes = begin(name)
    stretch = {"x": (0.6, 7, 7), "y": (7, 0.6, 7), "z": (7, 7, 0.6)}[along]
    position = nodes.coordinates([scale * s for s in stretch])
    figure = nodes.noise(position, 1.6, 5.0, 0.6, 1.4)
    rings = nodes.math("FRACT", nodes.math("MULTIPLY", figure, 9.0))
    pores = nodes.noise(position, 38.0, 3.0, 0.7)
    color = nodes.mix(nodes.remap(figure, 0.3, 0.7), dark, light)
    color = nodes.mix(nodes.math("MULTIPLY", rings, 0.35), color, dark)
    color = nodes.mix(
        nodes.remap(pores, 0.52, 0.75, 0.0, 0.75), color, [0.35 * c for c in dark]
    )
    rough = nodes.remap(pores, 0.4, 0.7, roughness, roughness + 0.2)
    finish(nodes, color, rough, nodes.bump(pores, 0.0004, 0.5))
    return material


def plaster(name, color, relief=0.0015, scale=60.0, stain=0.1):
    """Return painted plaster with roller relief and faint large stains."""
    material, nodes = begin(name)
    position = nodes.coordinates()
    rough = nodes.noise(position, scale, 8.0)
    patches = nodes.noise(position, 1.3, 6.0, 0.65)
    dim = [c * (1.0 - stain) for c in color]
    tone = nodes.mix(nodes.remap(patches, 0.35, 0.65), dim, color)
    finish(nodes, tone, 0.75, nodes.bump(rough, relief, 0.6))
    return material


def weave(name, first, second, period=0.007, check=0.0, translucent=0.0):
    """Return cloth of two yarns, @p period metres apart, in checks of @p check m."""
    material, nodes = begin(name)
    position = nodes.coordinates()
    parts = nodes.add("SeparateXYZ", {0: position}).outputs
    turn = 6.2831853 / period
    warp = nodes.math("SINE", nodes.math("MULTIPLY", parts[0], turn))
    weft = nodes.math("SINE", nodes.math("MULTIPLY", parts[1], turn))
    over = nodes.remap(nodes.math("MULTIPLY", warp, weft), -1.0, 1.0)
    fuzz = nodes.noise(position, 0.6 / period, 4.0, 0.7)
    color = nodes.mix(nodes.remap(over, 0.3, 0.7), first, second)
    if check > 0:
        squares = nodes.add("TexChecker", {"Vector": position, "Scale": 1 / check})
        darker = nodes.mix(1.0, color, (0.45, 0.35, 0.35), "MULTIPLY")
        color = nodes.mix(squares.outputs["Fac"], color, darker)
    color = nodes.mix(nodes.remap(fuzz, 0.3, 0.8, 0.0, 0.4), color, first)
    normal = nodes.bump(nodes.math("ADD", over, fuzz), period * 0.25, 0.7)
    cloth = nodes.add("BsdfDiffuse", {"Color": color, "Normal": normal}).outputs[0]
    through = nodes.add("BsdfTranslucent", {"Color": color}).outputs[0]
    nodes.output(nodes.blend(translucent, cloth, through))
    return material

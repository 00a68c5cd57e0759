# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""An OCIO chain as GLSL, and pixels drawn with it on a GPU without a window."""

import numpy as np
import PyOpenColorIO as ocio

VERTICES = """#version 430
in vec2 position;
void main() { gl_Position = vec4(position, 0.0, 1.0); }
"""
FRAGMENTS = """#version 430
uniform sampler2D scene;
out vec4 camera;
%s
void main() { camera = OCIOMain(texelFetch(scene, ivec2(gl_FragCoord.xy), 0)); }
"""


def shader_of(transform):
    """Return the GpuShaderDesc of a transform, GLSL 4."""
    processor = ocio.Config.CreateRaw().getProcessor(transform)
    shader = ocio.GpuShaderDesc.CreateShaderDesc(language=ocio.GPU_LANGUAGE_GLSL_4_0)
    shader.setAllowTexture1D(False)  # moderngl has none
    processor.getDefaultGPUProcessor().extractGpuShaderInfo(shader)
    return shader


def textures(shader):
    """Return how many textures a shader reads."""
    return len(list(shader.getTextures())) + len(list(shader.get3DTextures()))


def drawn(context, shader, pixels):
    """Return (H, W, 3) float32 of (H, W, 3) pixels, in a moderngl context."""
    height, width, _ = pixels.shape
    scene = context.texture((width, height), 3, pixels.tobytes(), dtype="f4")
    target = context.texture((width, height), 4, dtype="f4")
    program = context.program(VERTICES, FRAGMENTS % shader.getShaderText())
    square = np.array([-1, -1, 1, -1, -1, 1, 1, 1], np.float32)
    frame = context.framebuffer([target])
    frame.use()
    kept = bound(context, program, shader)
    scene.use(0)
    array = context.simple_vertex_array(program, context.buffer(square), "position")
    array.render(5)  # GL_TRIANGLE_STRIP
    del kept
    return np.frombuffer(target.read(), np.float32).reshape(height, width, 4)[..., :3]


def bound(context, program, shader):
    """Return the textures of a shader, bound from unit 1 on; they must outlive it."""
    flat, solid = list(shader.getTextures()), list(shader.get3DTextures())
    found = [
        context.texture(
            (lut.width, lut.height), 3, lut.getValues().tobytes(), dtype="f4"
        )
        for lut in flat
    ]
    found += [
        context.texture3d([lut.edgeLen] * 3, 3, lut.getValues().tobytes(), dtype="f4")
        for lut in solid
    ]
    for unit, (lut, texture) in enumerate(zip(flat + solid, found, strict=True), 1):
        texture.repeat_x = texture.repeat_y = False
        texture.use(unit)
        program[lut.samplerName] = unit
    return found

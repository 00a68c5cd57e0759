# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Captures with hidden effects, by independent physics: electrons, numpy and scipy.

Nothing here calls the effects, the simulation or the diagnosis: what is hidden is not
drawn by the code that has to find it. Of a sensor it reads numbers only.

camera      what a profile says, in electrons
scenes      what stands before the lens
strengths   the effects that can be hidden, and how strong
light       colour and optics
charge      mosaic to electrons, fixed patterns
readout     noise, clipping, ADC, noise reduction
photons     the density of counted photons
measured    lenses and read noise as others measured them
density     the true log density of what was read out
posterior   what fit frames tell of fixed patterns: the feasible truth
conditions  what goes wrong with a capture, and not with a camera
synthetic_camera  one with hidden effects, and the frames that it takes
sensors     sensors with made-up noise
captures    captures of a synthetic camera, as a CaptureSet and as a folder
disk        captures.yaml, DNGs, renders, the sealed truth
"""

from cg2raw.synthetic.captures import draw_hidden, simulate_captures

__all__ = ["draw_hidden", "simulate_captures"]

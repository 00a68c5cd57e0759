# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What cg2raw's pages measure and show; no part of cg2raw, and not in its wheel.

Here is the evidence study: what training data by cg2raw is worth beside real RAW.
Scenes of measured spectra are coloured twice: as a camera sees them, and as a renderer
would. Rooms, each importing from those before it: protocol, places, world, cameras,
sources, mitsuba_judge, learners, tasks, results, tables, draws, figures, docs_page,
main. Studies of their own are spectra, illuminants, diagnose and bench; pictures makes
those of the pages, scenes and night_scenes run in Blender."""

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The evidence study: what training data by cg2raw is worth beside real RAW.

Scenes of measured spectra are coloured twice: as a camera sees them, and as a renderer
would. Rooms, each importing from those before it: protocol, places, world, cameras,
sources, mitsuba_judge, learners, tasks, results, tables, draws, figures, docs_page,
main. Nothing here is part of the wheel."""

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Render a study: daylight from a window, tungsten lamps, a 24 patch chart.

Usage: python interior.py OUT.exr [--samples N] [--width W]
Units: metres, radiance such that white paper under the window is near 0.8."""

import math

import interior_chart as chart
import interior_lamps as lamps
import interior_room as room
import interior_still_life as still_life
import scene_geometry as geometry
import scene_materials as materials
import scene_render as render
from interior_furniture import TABLE_TOP, furniture
from interior_room import LEFT, WINDOW_Z, WINDOWS_Y

ASPECT = 4 / 3
CHART = (0.0, 1.98, TABLE_TOP + 0.127)
CHART_TURN, CHART_LEAN = math.radians(-4), math.radians(9)


def table_ware():
    """Everything on the table but the chart."""
    z = TABLE_TOP
    lamps.table_lamp((0.56, 2.40, z))
    lamps.filament_bulb((0.18, 2.52, 1.86), 0.74)
    still_life.glassware((-0.33, 2.20, z), (-0.45, 2.10, z))
    still_life.metalware((0.30, 2.42, z), (0.29, 2.02, z), (0.42, 2.08, z))
    still_life.fruit_bowl((-0.70, 2.02, z))
    still_life.pencils((0.16, 2.27, z))
    paper = still_life.paper_block()
    stack = (
        ("red", (0.45, 0.008, 0.012), 0.24, 0.17, 0.035, 0.15),
        ("blue", (0.008, 0.03, 0.38), 0.22, 0.16, 0.028, -0.1),
        ("yellow", (0.75, 0.48, 0.01), 0.20, 0.14, 0.022, 0.3),
        ("green", (0.01, 0.25, 0.06), 0.18, 0.12, 0.03, 0.05),
    )
    for name, color, length, depth, thick, turn in stack:
        cloth = materials.plaster(name, color, 0.0004, 900.0)
        still_life.book((length, depth, thick), (-0.52, 2.44, z), cloth, paper, turn)
        z += thick
    sheet = materials.matte("paper", (0.84, 0.84, 0.83))
    geometry.box(
        "paper",
        (0.21, 0.297, 0.0006),
        (-0.36, 1.91, TABLE_TOP + 0.0004),
        sheet,
        render.degrees(0, 0, 72),
        edge=0,
    )
    still_life.plant((-1.0, 2.42, TABLE_TOP))


def lights():
    """The sun low in the window, and a bright, partly clouded sky."""
    sun = render.light("SUN", (-8, 4, 9), 14.0, 5500, angle=0.0093)
    sun.rotation_euler = (0, 0, 0)
    render.aim(sun, (-8 + 0.62, 4 - 0.30, 9 - 0.74))
    render.sky(
        (13.0, 14.4, 16.2), (6.0, 8.1, 12.4), (2.2, 2.5, 1.4), (21.0, 21.0, 21.3)
    )
    z0, z1 = WINDOW_Z
    for y0, y1 in WINDOWS_Y:
        place = (LEFT - 0.2, (y0 + y1) / 2, (z0 + z1) / 2)
        portal = render.light(
            "AREA",
            place,
            1.0,
            target=(0, *place[1:]),
            shape="RECTANGLE",
            size=z1 - z0,
            size_y=y1 - y0,
        )
        portal.data.cycles.is_portal = True


def main():
    """Build the room and render it."""
    options = render.arguments(__doc__, 96, 1664)
    render.begin()
    room.shell()
    room.window()
    room.garden()
    furniture()
    table_ware()
    board = chart.chart(CHART, CHART_TURN, CHART_LEAN)
    lights()
    render.camera((0.74, 0.08, 1.34), (-0.25, 2.2, 1.34), 31.0, -0.15, CHART, 11.0)
    render.run(options, ASPECT, 5)
    for number, centre in enumerate(chart.patch_centres(), 1):
        x, y = render.pixel_of(board, centre)
        print(f"patch {number:2d} centre {x:7.1f} {y:7.1f} px")


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Correlated colour temperature by Robertson's isotherms.

Source: A. R. Robertson, J. Opt. Soc. Am. 58(11), 1968; numbers as in Wyszecki & Stiles,
Color Science, 2nd edition, table 1(3.11)."""

import numpy as np

# Columns: mired, u, v (CIE 1960), slope of the isotherm.
ISOTHERMS = np.array(
    [
        (0.0, 0.18006, 0.26352, -0.24341),
        (10.0, 0.18066, 0.26589, -0.25479),
        (20.0, 0.18133, 0.26846, -0.26876),
        (30.0, 0.18208, 0.27119, -0.28539),
        (40.0, 0.18293, 0.27407, -0.30470),
        (50.0, 0.18388, 0.27709, -0.32675),
        (60.0, 0.18494, 0.28021, -0.35156),
        (70.0, 0.18611, 0.28342, -0.37915),
        (80.0, 0.18740, 0.28668, -0.40955),
        (90.0, 0.18880, 0.28997, -0.44278),
        (100.0, 0.19032, 0.29326, -0.47888),
        (125.0, 0.19462, 0.30141, -0.58204),
        (150.0, 0.19962, 0.30921, -0.70471),
        (175.0, 0.20525, 0.31647, -0.84901),
        (200.0, 0.21142, 0.32312, -1.0182),
        (225.0, 0.21807, 0.32909, -1.2168),
        (250.0, 0.22511, 0.33439, -1.4512),
        (275.0, 0.23247, 0.33904, -1.7298),
        (300.0, 0.24010, 0.34308, -2.0637),
        (325.0, 0.24792, 0.34655, -2.4681),
        (350.0, 0.25591, 0.34951, -2.9641),
        (375.0, 0.26400, 0.35200, -3.5814),
        (400.0, 0.27218, 0.35407, -4.3633),
        (425.0, 0.28039, 0.35577, -5.3762),
        (450.0, 0.28863, 0.35714, -6.7262),
        (475.0, 0.29685, 0.35823, -8.5955),
        (500.0, 0.30505, 0.35907, -11.324),
        (525.0, 0.31320, 0.35968, -15.628),
        (550.0, 0.32129, 0.36011, -23.325),
        (575.0, 0.32931, 0.36038, -40.770),
        (600.0, 0.33724, 0.36051, -116.45),
    ]
)

# The u that raw converters use at 325 mired; the book's misprint. DESIGN.md 3.2.
ADOBE_U_AT_325 = 0.24702


def table(name):
    """The isotherms of "adobe" or "corrected": (31, 4)."""
    rows = ISOTHERMS.copy()
    if name == "adobe":
        rows[rows[:, 0] == 325.0, 1] = ADOBE_U_AT_325
    return rows


def uv_from_xy(xy):
    x, y = xy
    divisor = -2.0 * x + 12.0 * y + 3.0
    return np.array([4.0 * x / divisor, 6.0 * y / divisor])


def temperature(xy, name):
    """(CCT in kelvin, Duv) of a chromaticity; Duv is positive above the locus.

    Before the line of 10 mired that line answers, after that of 600 mired that one."""
    rows = table(name)
    point = uv_from_xy(xy)
    along = np.stack([np.ones(len(rows)), rows[:, 3]], axis=1)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    offset = point - rows[:, 1:3]
    # Signed distance to each line: the cross product with its direction.
    distance = along[:, 0] * offset[:, 1] - along[:, 1] * offset[:, 0]
    behind = np.flatnonzero(distance[1:] <= 0.0)
    last = behind[0] + 1 if len(behind) else len(rows) - 1
    if last == 1 or distance[last] > 0.0:
        share = 0.0
    else:
        share = -distance[last] / (distance[last - 1] - distance[last])

    def between(column):
        return share * column[last - 1] + (1.0 - share) * column[last]

    direction = between(along)
    off_locus = point - between(rows[:, 1:3])
    duv = -off_locus @ direction / np.linalg.norm(direction)
    return 1e6 / between(rows[:, 0]), duv

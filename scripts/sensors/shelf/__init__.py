# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The bundled cameras: which row of which published table each number is from.

To add a camera, add one entry to a file cameras_*.py; `profile.py` lists the keys.
"""

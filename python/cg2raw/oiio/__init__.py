# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""OpenImageIO: the module, the hosts of a machine, and the DNG plugin for each."""

# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Assessment: held-out frames become evidence: residual tests, gap, verdict."""

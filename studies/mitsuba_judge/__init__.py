# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The second judge: streets and squares at night, rendered in spectra by Mitsuba 3.

No source of the study is trained on them. things, spectra, plans and scene say what
stands where, drawn from an index, with spectra of the test half of the world alone;
build makes a scene of Mitsuba of it and worker renders that, both in a Python
environment that has mitsuba; folder keeps the frames and loads them; run, report and
main are the command ./studies/run mitsuba-judge."""

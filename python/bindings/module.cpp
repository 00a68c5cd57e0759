// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "bindings.h"

PYBIND11_MODULE(_core, m)
{
    namespace py = pybind11;
    m.doc() = "The C++ core of cg2raw: sensor model, simulation, DNG.";
    m.attr("__version__") = CG2RAW_VERSION;
    py::register_exception<cg2raw::Error>(m, "Error", PyExc_ValueError);
    cg2raw::python::bind_color(m);
    cg2raw::python::bind_scene_file(m);
    cg2raw::python::bind_encoding(m);
    cg2raw::python::bind_profile(m);
    cg2raw::python::bind_spectral_image(m);
    cg2raw::python::bind_transform(m);
    cg2raw::python::bind_simulation(m);
    cg2raw::python::bind_signal(m);
    cg2raw::python::bind_prediction(m);
    cg2raw::python::bind_frame_statistics(m);
    cg2raw::python::bind_shot(m);
    cg2raw::python::bind_dng(m);
    cg2raw::python::bind_export(m);
    cg2raw::python::bind_file(m);
}

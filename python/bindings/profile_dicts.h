// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The parts of a profile as dicts of Python.
#pragma once

#include "bindings.h"

#include "cg2raw/effect.h"

#include <optional>
#include <vector>

namespace cg2raw::python {

py::dict dict_of(const NoiseAtIso& noise);
py::dict dict_of(const Calibration& calibration);
py::object dict_of(const std::optional<SpectralSensitivities>& sensitivities);
py::dict dict_of(const NeutralDistribution& lights);
py::dict dict_of(const Lamp& lamp);
py::object dict_of(const std::optional<DigitalGain>& gain);
py::dict dict_of(const EffectSetting& setting);
/// @p of_cfa : the parameters that the effect has for one CFA, or for all.
py::dict dict_of(const Effect& effect, const std::vector<Parameter>& of_cfa);

} // namespace cg2raw::python

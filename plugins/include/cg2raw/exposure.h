// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file How much light of a scene reaches the sensor: stops, a light meter, or the
/// settings of a camera.
#pragma once

#include "cg2raw/profile.h"
#include "cg2raw/run.h"

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace cg2raw {

/// "1.5" (stops), "auto", "auto:PERCENTILE:LEVEL", "random:LOW:HIGH", "normal:MEAN:SD",
/// "match:FILE" or "match:FILE:draw", whose distributions are read. Throws Error that
/// says what is allowed.
ExposureRule exposure_from_text(const std::string& text);
/// "LOW:HIGH", both above 0; numbers as seconds_from_text() takes them. Throws Error.
Limits limits_from_text(const std::string& text);
/// "0.5" or "1/60", above 0 and at most 1e6. Throws Error.
double seconds_from_text(std::string_view text);

/// How messages name a setting with a value, or by its name alone: f_number, "2.8".
using SettingName = std::function<std::string(std::string_view, std::string_view)>;

/// What an exposure was decided to be.
struct SettledExposure {
    double gain = 1.0; ///< on scene-linear values, before anything clips
    double gain_stops = 0.0; ///< the same, in stops, but for the bracket
    /// Given, drawn or found, without what settings and bracket do; none: not asked
    /// for.
    std::optional<double> stops;
    /// Given or found; the time of a bracket is its own.
    std::optional<double> exposure_time, f_number, iso;
};

/// Decides an exposure. With scene_luminance the signal of value 1 is
/// q L t / N^2 S / 78 of white: the focal plane exposure H = q L t / N^2 of a lens
/// focused at infinity, q = 0.65, and saturation at 78 / S lux seconds. S is the ISO,
/// or the sensor's base ISO where that is higher: a sensor saturates no later. Throws
/// Error for a setting that is missing, superfluous or out of range, for a distribution
/// of another sensor, and for a meter that has not been read. Source: ISO 12232:2019.
SettledExposure settle(const SensorProfile& profile, const Run& run,
                       const SettingName& name);
/// Settings are named as keywords: f_number=2.8.
SettledExposure settle(const SensorProfile& profile, const Run& run);

/// Whether the run needs the whole scene before its first pixel is simulated.
bool needs_meter(const Run& run);

} // namespace cg2raw

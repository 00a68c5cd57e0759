// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file 5 - Effects of optics, sensor and read-out: what each is, and the one
/// registry.
#pragma once

#include "cg2raw/glare_context.h"
#include "cg2raw/mosaic.h"
#include "cg2raw/random.h"

#include <optional>
#include <vector>

namespace cg2raw {

/// Where in the chain an effect stands; the order is the order of application.
enum class Stage {
    color, ///< on camera RGB, three planes, as light that enters the lens
    optics, ///< likewise, as light that reaches the sensor
    pixel, ///< from here on: on the mosaic
    response,
    noise, ///< of light and of charge
    saturation, ///< on signal and noise so far, together
    readout,
    adc,
    processing, ///< in the camera, on signal and noise together
};
const char* name_of(Stage stage);

/// Fixed patterns are keyed by the sensor's serial, temporal ones by the frame too.
enum class Pattern { none, fixed, temporal };
const char* name_of(Pattern pattern);

/// For which CFAs a parameter has a meaning.
enum class CfaRepeat {
    any,
    colors, ///< of any that has filters: its effect tells colours apart
    other_color, ///< likewise, of red or blue beside what all light has
    bayer, ///< of a 2x2 repeat
    first_site, ///< of the first site of a 2x2 repeat, or of the one without filters
    other_site, ///< of another site of a 2x2 repeat
};

struct Parameter {
    std::string name, unit;
    double min, max;
    double null; ///< switches the effect off
    std::string meaning;
    CfaRepeat repeat = CfaRepeat::any;
    bool whole = false; ///< a whole number
    bool optional = false; ///< null where a setting does not have it
};

/// Signals of this and above count as clipped: some chains round white down.
constexpr float saturated = 0.99999f;

/// What all blocks of a frame have in common.
struct Exposure {
    Size frame; ///< active area
    CfaPattern cfa;
    Vec3 neutral { 1, 1, 1 }; ///< camera RGB of white, largest 1
    std::optional<double> seconds; ///< exposure time
    const GlareContext* glare_context = nullptr; ///< where an effect needs it
};

/// A block on its way through the sensor, with what it knows of its place. Signal is in
/// units of 0..1 above black; variance in the square of that.
struct Signal {
    int planes; ///< 3: camera RGB, 1: mosaic
    std::array<Plane<float>, 3> mean;
    Plane<float> variance; ///< mosaic only; its data is null before the mosaic
    Plane<float> noise; ///< likewise; what was drawn, until it is added
    Site origin; ///< of the block's first pixel in the active area
    Exposure exposure;
};

/// Parameter values in the order of parameters_of().
using Values = std::vector<double>;
/// An effect's name and its values.
using NamedValues = std::pair<std::string, Values>;

/// One departure from the ideal sensor. It states how it moves the expected signal and
/// its variance (predict) and, if its draw is not the Gaussian of that variance, how to
/// draw.
///
/// A prediction calls every effect's predict. A simulation calls draw where there is
/// one and predict where there is none, and draws the Gaussian of the variances that
/// the latter add up to: nothing is drawn twice. In the stages noise and readout a draw
/// adds to Signal::noise and leaves the mean alone, so that the order of effects does
/// not matter there; the sum falls on the sites that were not clipped before. In other
/// stages a draw moves the mean: from stage saturation on, but for readout, the mean
/// of a simulation holds the noise. A fixed pattern is no surprise: a prediction draws
/// it too.
///
/// An effect that reaches farther than its pixel mirrors the block at its edges: those
/// of the frame are right, and of other edges the caller discards as many pixels.
struct Effect {
    std::string name;
    Stage stage;
    Pattern pattern;
    std::vector<Parameter> parameters;
    std::string meaning, source;
    void (*predict)(Signal&, const Values&);
    void (*draw)(Signal&, const Values&, const Rng&) = nullptr;
    int reach = 0; ///< pixels around a site that its result depends on
    bool needs_glare_context = false;
    bool needs_exposure_time = false;
    /// The draw of an effect that has none, where its noise is not white: then it stays
    /// out of the Gaussian that others share.
    void (*draw_apart)(Signal&, const Values&, const Rng&) = nullptr;
};

/// All effects, in stage order, then by name.
const std::vector<Effect>& all_effects();

/// The JSON Schema of a profile (profile.h), in which its effects are those of the
/// registry.
std::string profile_schema();
/// What an effect of this name is called now; the name itself if it was never another.
std::string_view current_effect_name(std::string_view name);
/// Throws Error that lists the names, or says the new name of one that was renamed.
const Effect& effect(std::string_view name);
/// Whether a profile of a CFA may list an effect.
bool has_effect(const CfaPattern& cfa, const Effect& effect);
/// The parameters that an effect has on a CFA, in their order: a monochrome sensor has
/// one site. Throws Error if the CFA has none of the effect; @p file leads the message.
std::vector<Parameter> parameters_of(const Effect& effect, const CfaPattern& cfa,
                                     const std::string& file);
/// Values of a setting: every parameter that the CFA has, but for optional ones, given
/// and within its bounds. Throws Error.
Values values_of(const Effect& effect, const std::map<std::string, double>& parameters,
                 const CfaPattern& cfa, const std::string& file);

} // namespace cg2raw

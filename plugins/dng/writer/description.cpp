// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "cg2raw/dng_writer.h"
#include "cg2raw/exposure.h"

#include "effects/color_shading.h"
#include "effects/lens_shading.h"

#include <algorithm>
#include <cmath>

namespace cg2raw {

namespace {

/// EXIF LightSource of D65.
constexpr int daylight = 21;
/// Fine enough for a polynomial of degree six between bilinear nodes: 1e-4 of the gain.
constexpr int map_rows = 49;
constexpr int map_cols = 65;
/// NoiseProfile allows no scale of 0.
constexpr double least_scale = 1e-12;

/// The one matrix by which a reader that inverts it for D65 and divides by the neutral
/// gives linear sRGB back: diag(neutral) . balanced from sRGB . sRGB from XYZ.
Calibration exact_calibration(const Simulation& simulation)
{
    const Illuminant& light = simulation.illuminant();
    if (simulation.profile().cfa.is_mono())
        throw Error("matrices exact: sensor " + simulation.profile().id
                    + " is monochrome, and its file has no matrices: say camera");
    const Mat3 balanced_from_srgb
        = inverse(srgb_from_balanced(simulation.profile(), light));
    const Mat3 srgb_from_xyz = inverse(xyz_d65_from_srgb());
    return { daylight, diagonal(light.neutral) * balanced_from_srgb * srgb_from_xyz,
             std::nullopt };
}

/// RawTherapee by default, and Adobe's renderers, prefer their own profile of a camera
/// whose name they know (Canon EOS 5D Mark III: mean dE2000 2.6, Nikon D800: 6.1, not
/// 0.014). This matrix is one file's, not that camera's: the name says so.
std::string name_of_exact(const std::string& model)
{
    const std::string ending = " exact";
    const bool has_it = model.size() > ending.size()
        && model.compare(model.size() - ending.size(), ending.size(), ending) == 0;
    return has_it ? model : model + ending;
}

/// Noise that stands among the profile's effects rather than at an ISO.
std::optional<NoiseAtIso> noise_of_effects(const Simulation& simulation)
{
    const auto shot = simulation.active("shot_noise");
    const auto read = simulation.active("read_noise");
    if (!shot || !read)
        return std::nullopt;
    return NoiseAtIso { 0.0, *shot, *read };
}

/// The planes' noise: means over the sites of a colour; one pair without colours.
std::vector<NoisePair> noise_profile(const NoiseAtIso& noise, const CfaPattern& cfa)
{
    if (cfa.is_mono())
        return { { std::max(noise.beta1.at(0), least_scale),
                   std::max(noise.beta2.at(0), 0.0) } };
    std::vector<NoisePair> pairs(3, NoisePair { 0.0, 0.0 });
    std::array<int, 3> count {};
    for (std::size_t site = 0; site < std::size_t(cfa.sites()); ++site) {
        const std::size_t color = cfa.colors[site];
        pairs[color].scale += noise.beta1.at(site);
        pairs[color].offset += noise.beta2.at(site);
        ++count[color];
    }
    for (std::size_t color = 0; color < 3; ++color) {
        NoisePair& pair = pairs[color];
        pair = { std::max(pair.scale / count[color], least_scale),
                 std::max(pair.offset / count[color], 0.0) };
    }
    return pairs;
}

/// What light of the colours R, G, B loses on its way: of the active effects.
struct FallOff {
    std::optional<Values> lens, color;

    explicit operator bool() const { return lens || color; }
    double at(int plane, double u, double v) const
    {
        return (lens ? lens_shading_at(*lens, u, v) : 1.0)
            * (color ? color_shading_at(*color, plane, u, v) : 1.0);
    }
};

/// Reciprocals of a colour's fall-off; the first and last node lie on the frame's
/// edges.
GainMap gains_against(const FallOff& shading, int plane, Size frame)
{
    const double half_diagonal = 0.5 * std::hypot(frame.width, frame.height);
    GainMap map { map_rows, map_cols, {} };
    for (int row = 0; row < map_rows; ++row)
        for (int col = 0; col < map_cols; ++col) {
            const double u
                = (double(col) / (map_cols - 1) - 0.5) * frame.width / half_diagonal;
            const double v
                = (double(row) / (map_rows - 1) - 0.5) * frame.height / half_diagonal;
            // Where nothing is left, nothing can be restored.
            constexpr double darkest = 1e-3;
            map.gains.push_back(
                float(1.0 / std::max(shading.at(plane, u, v), darkest)));
        }
    return map;
}

/// Bv = Av + Tv - Sv: what a camera's meter saw that chose these settings. Source: Exif
/// 2.3 (CIPA DC-008-2012), annex C: Sv = log2(0.32 S).
double apex_brightness(double seconds, double f_number, double iso)
{
    return std::log2(f_number * f_number / seconds / (0.32 * iso));
}

/// What the file says of how it was made.
Origin origin_of(const Simulation& simulation)
{
    const Run& run = simulation.run();
    Origin origin;
    origin.sensor = simulation.profile().id;
    origin.illuminant = run.illuminant;
    const double kelvin = simulation.illuminant().temperature.cct.value;
    if (std::isfinite(kelvin) && !run.illuminant.empty())
        origin.temperature = kelvin;
    origin.iso = run.iso;
    // Pixels of a RAW space were converted elsewhere, as nobody says.
    if (!run.camera_input) {
        origin.convention = name_of(run.convention);
        origin.digital_gain = simulation.digital_gain();
    }
    if (run.exposure || run.scene_luminance || run.bracket)
        origin.exposure = simulation.exposure().gain_stops + run.bracket.value_or(0.0);
    if (run.exposure)
        origin.exposure_rule = run.exposure->text;
    origin.seed = run.seed;
    origin.frame = run.frame;
    origin.effects = simulation.effects();
    return origin;
}

/// What a camera says of the exposure, of the settings that a simulation was of.
Shot exposed(Shot shot, const Simulation& simulation)
{
    const Run& run = simulation.run();
    if (run.exposure_time && *run.exposure_time > 0.0)
        shot.exposure_time = run.exposure_time;
    if (run.f_number)
        shot.f_number = run.f_number;
    if (run.iso)
        shot.iso = int(std::lround(*run.iso));
    if (run.exposure || run.bracket) {
        const bool is_chosen = run.exposure && !needs_meter(run);
        const double stops
            = is_chosen ? simulation.exposure().stops.value_or(0.0) : 0.0;
        shot.exposure_bias = stops + run.bracket.value_or(0.0);
    }
    if (run.bracket)
        shot.exposure_mode = ExposureMode::bracket;
    else if (needs_meter(run))
        shot.exposure_mode = ExposureMode::automatic;
    else if (run.scene_luminance)
        shot.exposure_mode = ExposureMode::manual;
    if (needs_meter(run) && run.scene_luminance)
        shot.brightness = apex_brightness(*run.exposure_time, *run.f_number, *run.iso);
    return shot;
}

} // namespace

DngDescription describe(const Simulation& simulation, const DngOptions& options,
                        const Shot& shot)
{
    const SensorProfile& profile = simulation.profile();
    DngDescription description {
        simulation.frame(),
        profile.cfa,
        profile.black_level,
        profile.white_level,
        profile.calibrations,
        simulation.illuminant().neutral,
        profile.make,
        profile.model,
        profile.unique_camera_model,
        {},
        std::nullopt,
        srgb_from_balanced(profile, simulation.illuminant()),
        exposed(shot, simulation),
        origin_of(simulation),
    };
    if (options.matrices == Matrices::exact) {
        description.calibrations = { exact_calibration(simulation) };
        description.model = name_of_exact(profile.model);
        description.unique_camera_model = name_of_exact(profile.unique_camera_model);
    }
    if (simulation.noise())
        description.noise_profile = noise_profile(*simulation.noise(), profile.cfa);
    else if (const auto noise = noise_of_effects(simulation))
        description.noise_profile = noise_profile(*noise, profile.cfa);
    const FallOff shading { simulation.active("lens_shading"),
                            simulation.active("color_shading") };
    const Shading usual = is_of_shot(shot) ? Shading::baked : Shading::tagged;
    if (shading && options.shading.value_or(usual) == Shading::tagged)
        description.shading_gains = { gains_against(shading, 0, simulation.frame()),
                                      gains_against(shading, 1, simulation.frame()),
                                      gains_against(shading, 2, simulation.frame()) };
    return description;
}

} // namespace cg2raw

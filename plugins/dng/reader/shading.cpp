// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file From the GainMaps of real files to the parameters of the effect lens_shading,
/// and of color_shading where the colours' maps differ.
///
/// A GainMap undoes the shading: shading = 1 / gain. The effect's polynomial is linear
/// in its parameters, so least squares over the points of the maps find them. A factor
/// for the whole frame is fitted along and left out: a maker's gain is 1 where his lens
/// is brightest, the effect's where the frame's centre is, and exposure makes up for
/// it.
#include "effects/lens_shading.h"
#include "reader/gain_maps.h"
#include "reader/least_squares.h"
#include "reader/profile_parts.h"
#include "tiff/tag_numbers.h"

#include "cg2raw/effect.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace cg2raw {
namespace {

/// Unknowns: the factor for the frame, then parameters of the effect in its order.
template <std::size_t parameters> using Equations = LeastSquares<parameters + 1>;

/// What is smaller than this is called negligible: half of the photon noise of a pixel
/// that holds 10000 electrons.
constexpr double negligible = 0.005;
/// Parameters below this are those of no shading.
constexpr double null_parameter = 1e-6;

/// The terms of lens_shading_at() at a place, each times its unknown.
template <std::size_t parameters>
typename Equations<parameters>::Row terms_at(Place at, Size size)
{
    const auto [u, v] = field_offset(at, size);
    const auto terms = lens_shading_terms(u, v);
    typename Equations<parameters>::Row row { 1.0 };
    std::copy_n(terms.begin(), parameters, row.begin() + 1);
    return row;
}

struct Fit {
    double scale; ///< shading of the maps at the frame's centre
    Values values;
    /// What the polynomial leaves, relative to the maps' shading at the same place: in
    /// a dark corner as much as the corner's own brightness is wrong.
    double rms = 0.0, largest = 0.0;
};

/// The residuals of @p fit: rms and largest.
void measure(Fit& fit, const GainMapSamples& samples, Size size)
{
    double squares = 0.0;
    for (const ShadingAt& point : samples.points) {
        const auto [u, v] = field_offset(place_of(samples, point), size);
        const double fitted = fit.scale * lens_shading_at(fit.values, u, v);
        const double residual = fitted / point.shading - 1.0;
        squares += residual * residual;
        fit.largest = std::max(fit.largest, std::abs(residual));
    }
    fit.rms = std::sqrt(squares / double(samples.points.size()));
}

/// The fit of the effect's first parameters; nothing if the points do not determine
/// them.
template <std::size_t parameters>
std::optional<Fit> fit_of_first(const GainMapSamples& samples, Size size)
{
    Equations<parameters> equations;
    for (const ShadingAt& point : samples.points)
        equations.add(terms_at<parameters>(place_of(samples, point), size),
                      point.shading);
    const auto solution = equations.solved();
    if (!solution || !((*solution)[0] > 0.0))
        return std::nullopt;
    Fit fit { (*solution)[0], {} };
    for (std::size_t i = 1; i < solution->size(); ++i)
        fit.values.push_back((*solution)[i] / fit.scale);
    measure(fit, samples, size);
    return fit;
}

/// Which value is the first that is beyond its parameter's bounds.
std::optional<std::size_t> first_beyond(const Values& values, const Effect& effect)
{
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!(values[i] >= effect.parameters[i].min
              && values[i] <= effect.parameters[i].max))
            return i;
    return std::nullopt;
}

/// The fit of a round lens, or of one that is not where that leaves too much and there
/// are twice as many points as parameters; nothing if the points determine neither.
std::optional<Fit> fit_of(const GainMapSamples& samples, Size size)
{
    auto round = fit_of_first<round_lens_shading_size>(samples, size);
    if (!round || round->rms <= negligible
        || samples.points.size() < 2 * (lens_shading_size + 1))
        return round;
    auto whole = fit_of_first<lens_shading_size>(samples, size);
    const bool better = whole && whole->rms < round->rms
        && !first_beyond(whole->values, effect("lens_shading"));
    return better ? std::move(whole) : std::move(round);
}

bool same_optics(const DngMetadata& a, const DngMetadata& b)
{
    return a.shot.lens_model == b.shot.lens_model && a.shot.f_number == b.shot.f_number
        && a.shot.focal_length == b.shot.focal_length;
}

void note_differences(const std::vector<const DngMetadata*>& files,
                      std::size_t all_files, const GainMapSamples& samples,
                      Notes& notes)
{
    if (files.size() < all_files)
        notes.push_back("GainMap (" + std::string(tag::opcode_list_2.name) + ", "
                        + std::to_string(tag::opcode_list_2.number) + ") is in "
                        + std::to_string(files.size()) + " of "
                        + std::to_string(all_files)
                        + " files: lens_shading is that of these");
    const bool same = std::all_of(files.begin(), files.end(), [&](const auto* file) {
        return same_optics(*file, *files.front());
    });
    if (!same)
        notes.push_back("files with GainMaps differ in lens, focal length or aperture:"
                        " lens_shading is the mean of theirs, and no lens' own");
    if (samples.between_files > negligible)
        notes.push_back("GainMaps of the files differ by "
                        + rounded_text(100 * samples.between_files)
                        + " % rms: lens_shading is fitted to their mean");
}

void note_costs(const Fit& fit, const GainMapSamples& samples, bool colored,
                Notes& notes)
{
    if (fit.rms > negligible || fit.largest > 4 * negligible)
        notes.push_back("lens_shading leaves " + rounded_text(100 * fit.rms)
                        + " % rms of the GainMaps' brightness at the same place, "
                        + rounded_text(100 * fit.largest)
                        + " % at most: frames are so much too bright or dark there");
    if (samples.between_sites > negligible && !colored)
        notes.push_back("GainMaps of the CFA's sites differ by "
                        + rounded_text(100 * samples.between_sites)
                        + " % rms: colour shading is not simulated, lens_shading is the"
                          " mean of the sites");
}

/// What a fit may become.
enum class Use { effect, nothing, impossible };

/// Nothing if all is null; impossible, noted, if it is beyond the effect's bounds.
Use use_of(const Values& values, const Effect& effect, Notes& notes)
{
    if (const auto beyond = first_beyond(values, effect)) {
        const Parameter& parameter = effect.parameters[*beyond];
        notes.push_back("GainMaps would need " + parameter.name + " "
                        + rounded_text(values[*beyond]) + " of " + effect.name
                        + ", which is " + rounded_text(parameter.min) + " to "
                        + rounded_text(parameter.max) + ": it is not simulated");
        return Use::impossible;
    }
    const bool null = std::all_of(values.begin(), values.end(), [](double value) {
        return std::abs(value) < null_parameter;
    });
    return null ? Use::nothing : Use::effect;
}

std::string json_number(double value)
{
    char text[40];
    return { text, std::to_chars(text, text + sizeof text, value).ptr };
}

/// Which maps of which files, as JSON has it between quotes.
std::string source_of(const std::vector<const DngMetadata*>& files)
{
    std::vector<DngMetadata> named;
    for (const DngMetadata* file : files) {
        named.emplace_back();
        named.back().file = file->file;
    }
    const GainMap& map = files.front()->gain_maps.front().map;
    std::string source;
    for (char c : names_of_files(named))
        source += c == '"' || c == '\\' ? std::string("\\") + c : std::string(1, c);
    return source + ": " + std::to_string(files.front()->gain_maps.size())
        + " GainMaps of " + std::to_string(map.rows) + " x " + std::to_string(map.cols)
        + " (OpcodeList2)";
}

std::string evidence_of(const std::vector<const DngMetadata*>& files, const Fit& fit,
                        const GainMapSamples& samples)
{
    return "{\"evidence\": {\"source\": \"" + source_of(files)
        + "\", \"rms_residual\": " + json_number(fit.rms)
        + ", \"largest_residual\": " + json_number(fit.largest)
        + ", \"rms_between_sites\": " + json_number(samples.between_sites)
        + ", \"rms_between_files\": " + json_number(samples.between_files)
        + ", \"shading_at_centre\": " + json_number(fit.scale) + "}}";
}

std::string evidence_of(const std::vector<const DngMetadata*>& files,
                        const ColorShadingFit& fit)
{
    return "{\"evidence\": {\"source\": \"" + source_of(files)
        + "\", \"rms_residual\": " + json_number(fit.rms)
        + ", \"rms_between_colors\": " + json_number(fit.departure) + "}}";
}

EffectSetting setting_of(const Effect& effect, const Values& values,
                         const std::string& evidence)
{
    EffectSetting setting { effect.name, {}, evidence };
    for (std::size_t i = 0; i < values.size(); ++i)
        setting.parameters[effect.parameters[i].name] = values[i];
    return setting;
}

/// color_shading if the maps are of it; the points' shading becomes that of green,
/// which lens_shading is then.
std::optional<EffectSetting>
color_shading_of(const std::vector<const DngMetadata*>& files, GainMapSamples& samples,
                 Notes& notes)
{
    const Effect& color_shading = effect("color_shading");
    const auto fit = color_shading_fit(samples, files.front()->active_area);
    if (!fit || use_of(fit->values, color_shading, notes) != Use::effect)
        return std::nullopt;
    for (ShadingAt& point : samples.points)
        point.shading = green_shading(samples, point);
    notes.push_back("GainMaps of the colours differ by "
                    + rounded_text(100 * fit->departure)
                    + " % rms: this became the effect color_shading, which leaves "
                    + rounded_text(100 * fit->rms) + " %");
    return setting_of(color_shading, fit->values, evidence_of(files, *fit));
}

} // namespace

std::vector<EffectSetting> shading_of(const std::vector<DngMetadata>& files,
                                      Notes& notes)
{
    std::vector<const DngMetadata*> with_maps;
    for (const DngMetadata& file : files)
        if (!file.gain_maps.empty())
            with_maps.push_back(&file);
    if (with_maps.empty())
        return {};
    GainMapSamples samples = gain_map_samples(with_maps);
    note_differences(with_maps, files.size(), samples, notes);
    const auto of_colors = color_shading_of(with_maps, samples, notes);
    std::vector<EffectSetting> found;
    if (of_colors)
        found.push_back(*of_colors);
    const auto fit = fit_of(samples, with_maps.front()->active_area);
    if (!fit) {
        notes.push_back("GainMaps have too few points in the frame for the parameters"
                        " of lens_shading: shading is not simulated");
        return found;
    }
    const Effect& lens_shading = effect("lens_shading");
    if (use_of(fit->values, lens_shading, notes) != Use::effect)
        return found;
    notes.push_back("GainMaps of " + text_of(tag::opcode_list_2)
                    + " became the effect lens_shading:"
                      " frames are shaded as the camera's mosaics are");
    note_costs(*fit, samples, of_colors.has_value(), notes);
    found.push_back(
        setting_of(lens_shading, fit->values, evidence_of(with_maps, *fit, samples)));
    return found;
}

} // namespace cg2raw

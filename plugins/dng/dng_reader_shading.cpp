// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file From the GainMaps of real files to the parameters of the effect lens_shading.
///
/// A GainMap undoes the shading: shading = 1 / gain. The effect's polynomial is linear
/// in its parameters, so least squares over the points of the maps find them. A factor
/// for the whole frame is fitted along and left out: a maker's gain is 1 where his lens
/// is brightest, the effect's where the frame's centre is, and exposure makes up for
/// it.
#include "dng_reader_gain_maps.h"
#include "dng_reader_parts.h"

#include "cg2raw/effect.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace cg2raw {
namespace {

/// Unknowns: the factor for the frame, then the parameters of the effect in its order.
constexpr std::size_t unknowns = 8;
using Row = std::array<double, unknowns>;

/// What is smaller than this is called negligible: half of the photon noise of a pixel
/// that holds 10000 electrons.
constexpr double negligible = 0.005;
/// Parameters below this are those of no shading.
constexpr double null_parameter = 1e-6;

/// The terms of lens_shading_at() at a place, each times its unknown.
Row terms_at(Place at, Size size)
{
    const double half = std::hypot(size.width, size.height) / 2.0;
    const double u = (at.h - 0.5) * size.width / half;
    const double v = (at.v - 0.5) * size.height / half;
    const double square = u * u + v * v;
    return { 1.0, square, square * square, square * square * square,
             u,   v,      square * u,      square * v };
}

/// Solves the normal equations by Cholesky; nothing if the points do not determine all
/// unknowns. @p normal is overwritten.
std::optional<Row> solved(std::array<Row, unknowns>& normal, Row right)
{
    constexpr double singular = 1e-10;
    for (std::size_t j = 0; j < unknowns; ++j) {
        const double whole = normal[j][j];
        for (std::size_t k = 0; k < j; ++k)
            normal[j][j] -= normal[j][k] * normal[j][k];
        if (!(normal[j][j] > singular * whole))
            return std::nullopt;
        normal[j][j] = std::sqrt(normal[j][j]);
        for (std::size_t i = j + 1; i < unknowns; ++i) {
            for (std::size_t k = 0; k < j; ++k)
                normal[i][j] -= normal[i][k] * normal[j][k];
            normal[i][j] /= normal[j][j];
        }
        for (std::size_t k = 0; k < j; ++k)
            right[j] -= normal[j][k] * right[k];
        right[j] /= normal[j][j];
    }
    for (std::size_t j = unknowns; j-- > 0;) {
        for (std::size_t i = j + 1; i < unknowns; ++i)
            right[j] -= normal[i][j] * right[i];
        right[j] /= normal[j][j];
    }
    return right;
}

struct Fit {
    double scale; ///< shading of the maps at the frame's centre
    Values values;
    double rms = 0.0, largest = 0.0; ///< what the polynomial leaves, centre = 1
};

/// The residuals of @p fit: rms and largest.
void measure(Fit& fit, const GainMapSamples& samples, Size size)
{
    double squares = 0.0;
    for (const auto& [at, shading] : samples.points) {
        const Row terms = terms_at(at, size);
        double residual = shading / fit.scale - 1.0;
        for (std::size_t i = 1; i < unknowns; ++i)
            residual -= terms[i] * fit.values[i - 1];
        squares += residual * residual;
        fit.largest = std::max(fit.largest, std::abs(residual));
    }
    fit.rms = std::sqrt(squares / double(samples.points.size()));
}

/// Nothing if the points do not determine the parameters.
std::optional<Fit> fit_of(const GainMapSamples& samples, Size size)
{
    std::array<Row, unknowns> normal {};
    Row right {};
    for (const auto& [at, shading] : samples.points) {
        const Row terms = terms_at(at, size);
        for (std::size_t i = 0; i < unknowns; ++i) {
            right[i] += terms[i] * shading;
            for (std::size_t j = 0; j < unknowns; ++j)
                normal[i][j] += terms[i] * terms[j];
        }
    }
    const auto solution = solved(normal, right);
    if (!solution || !((*solution)[0] > 0.0))
        return std::nullopt;
    Fit fit { (*solution)[0], {} };
    for (std::size_t i = 1; i < unknowns; ++i)
        fit.values.push_back((*solution)[i] / fit.scale);
    measure(fit, samples, size);
    return fit;
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
        notes.push_back("GainMap (OpcodeList2, 51009) is in "
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

void note_costs(const Fit& fit, const GainMapSamples& samples, Notes& notes)
{
    if (fit.rms > negligible || fit.largest > 4 * negligible)
        notes.push_back("lens_shading leaves " + rounded_text(100 * fit.rms)
                        + " % rms of the GainMaps, " + rounded_text(100 * fit.largest)
                        + " % at most: this much of the shading is not simulated");
    if (samples.between_sites > negligible)
        notes.push_back("GainMaps of the CFA's sites differ by "
                        + rounded_text(100 * samples.between_sites)
                        + " % rms: colour shading is not simulated, lens_shading is the"
                          " mean of the sites");
}

/// True if the effect can be what was fitted, and is more than nothing.
bool usable(const Fit& fit, const Effect& effect, Notes& notes)
{
    bool null = true;
    for (std::size_t i = 0; i < fit.values.size(); ++i) {
        const Parameter& parameter = effect.parameters[i];
        const double value = fit.values[i];
        null = null && std::abs(value) < null_parameter;
        if (!(value >= parameter.min && value <= parameter.max)) {
            notes.push_back(
                "GainMaps would need " + parameter.name + " " + rounded_text(value)
                + " of lens_shading, which is " + rounded_text(parameter.min) + " to "
                + rounded_text(parameter.max) + ": shading is not simulated");
            return false;
        }
    }
    return !null;
}

std::string json_number(double value)
{
    char text[40];
    return { text, std::to_chars(text, text + sizeof text, value).ptr };
}

std::string evidence_of(const std::vector<const DngMetadata*>& files, const Fit& fit,
                        const GainMapSamples& samples)
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
    return "{\"evidence\": {\"source\": \"" + source + ": "
        + std::to_string(files.front()->gain_maps.size()) + " GainMaps of "
        + std::to_string(map.rows) + " x " + std::to_string(map.cols)
        + " (OpcodeList2)\", \"rms_residual\": " + json_number(fit.rms)
        + ", \"largest_residual\": " + json_number(fit.largest)
        + ", \"rms_between_sites\": " + json_number(samples.between_sites)
        + ", \"rms_between_files\": " + json_number(samples.between_files)
        + ", \"shading_at_centre\": " + json_number(fit.scale) + "}}";
}

} // namespace

std::optional<EffectSetting> lens_shading_of(const std::vector<DngMetadata>& files,
                                             Notes& notes)
{
    std::vector<const DngMetadata*> with_maps;
    for (const DngMetadata& file : files)
        if (!file.gain_maps.empty())
            with_maps.push_back(&file);
    if (with_maps.empty())
        return std::nullopt;
    const GainMapSamples samples = gain_map_samples(with_maps);
    note_differences(with_maps, files.size(), samples, notes);
    const auto fit = fit_of(samples, with_maps.front()->active_area);
    if (!fit) {
        notes.push_back("GainMaps have too few points in the frame for the parameters"
                        " of lens_shading: shading is not simulated");
        return std::nullopt;
    }
    const Effect& lens_shading = effect("lens_shading");
    if (!usable(*fit, lens_shading, notes))
        return std::nullopt;
    notes.push_back("GainMaps of OpcodeList2 (51009) became the effect lens_shading:"
                    " frames are shaded as the camera's mosaics are");
    note_costs(*fit, samples, notes);
    EffectSetting setting { lens_shading.name,
                            {},
                            evidence_of(with_maps, *fit, samples) };
    for (std::size_t i = 0; i < fit->values.size(); ++i)
        setting.parameters[lens_shading.parameters[i].name] = fit->values[i];
    return setting;
}

} // namespace cg2raw

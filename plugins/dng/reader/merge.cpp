// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Black levels, noise and neutrals of several DNGs of one camera as one.
#include "reader/profile_parts.h"
#include "tiff/tag_numbers.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace cg2raw {
namespace {

/// How far black levels of one camera lie apart: cameras measure them for each frame,
/// and shift them a little with ISO and temperature.
constexpr double black_spread_dn = 1.0, black_spread_of_white = 0.002;
/// Noise that differs by more, relative to its mean, is worth a note.
constexpr double noise_spread = 0.05;

using Range = std::pair<double, double>;

Range range_of(const std::vector<double>& values)
{
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return { *low, *high };
}

/// A pair of NoiseProfile per colour plane, of each file at one ISO.
using NoiseOfFiles = std::vector<const std::vector<NoisePair>*>;

/// The row of one ISO; the largest spread of a value over its mean goes to @p spread.
NoiseAtIso row_at(int iso, const NoiseOfFiles& files, const CfaPattern& cfa,
                  double& spread)
{
    std::vector<NoisePair> mean(files.front()->size(), NoisePair { 0.0, 0.0 });
    for (std::size_t plane = 0; plane < mean.size(); ++plane)
        for (double NoisePair::*part : { &NoisePair::scale, &NoisePair::offset }) {
            std::vector<double> values;
            for (const auto* pairs : files)
                values.push_back((*pairs)[plane].*part);
            const auto [low, high] = range_of(values);
            mean[plane].*part = mean_of(values);
            if (high > 0.0)
                spread = std::max(spread, (high - low) / (mean[plane].*part));
        }
    NoiseAtIso row { double(iso), {}, {} };
    for (int site = 0; site < cfa.sites(); ++site) {
        const NoisePair& pair = mean[cfa.is_mono() ? 0 : cfa.colors[std::size_t(site)]];
        row.beta1.push_back(pair.scale);
        row.beta2.push_back(pair.offset);
    }
    return row;
}

/// What a table of so many ISOs cannot do.
void note_isos(const std::vector<NoiseAtIso>& noise, Notes& notes)
{
    if (noise.empty())
        notes.push_back(text_of(tag::noise_profile)
                        + " with an ISO is in none of the files:"
                          " noise cannot be simulated, so no ISO (dng:iso) can be asked"
                          " for");
    if (noise.size() == 1)
        notes.push_back("noise is known at ISO " + rounded_text(noise[0].iso)
                        + " alone: no other ISO (dng:iso) can be asked for");
}

} // namespace

double mean_of(const std::vector<double>& values)
{
    double sum = 0.0;
    for (double value : values)
        sum += value - values.front();
    return values.front() + sum / double(values.size());
}

std::vector<double> merged_black_level(const std::vector<DngMetadata>& files,
                                       Notes& notes)
{
    const DngMetadata& first = files.front();
    const double allowed
        = std::max(black_spread_dn, black_spread_of_white * first.white_level);
    std::vector<double> merged;
    double widest = 0.0;
    for (std::size_t site = 0; site < first.black_level.size(); ++site) {
        std::vector<double> values;
        for (const DngMetadata& file : files)
            values.push_back(file.black_level[site]);
        const auto [low, high] = range_of(values);
        if (high - low > allowed) {
            const auto file_of = [&](double dn) {
                const auto at = std::find(values.begin(), values.end(), dn);
                return files[std::size_t(at - values.begin())].file;
            };
            throw Error(first.file + ": " + text_of(tag::black_level) + " is "
                        + rounded_text(low) + " DN in " + file_of(low) + " and "
                        + rounded_text(high) + " DN in " + file_of(high)
                        + "; it may differ by " + rounded_text(allowed)
                        + " DN: make a profile of each, by ISO or mode");
        }
        widest = std::max(widest, high - low);
        merged.push_back(mean_of(values));
    }
    if (widest > 0.0)
        notes.push_back(text_of(tag::black_level) + " differs by up to "
                        + rounded_text(widest)
                        + " DN between the files: its mean stands for all");
    return merged;
}

std::vector<NoiseAtIso> merged_noise(const std::vector<DngMetadata>& files,
                                     Notes& notes)
{
    std::map<int, NoiseOfFiles> by_iso;
    for (const DngMetadata& file : files)
        if (!file.noise_profile.empty() && file.shot.iso)
            by_iso[*file.shot.iso].push_back(&file.noise_profile);
    std::vector<NoiseAtIso> noise;
    for (const auto& [iso, profiles] : by_iso) {
        double spread = 0.0;
        noise.push_back(row_at(iso, profiles, files.front().cfa, spread));
        if (spread > noise_spread)
            notes.push_back(text_of(tag::noise_profile) + " at ISO "
                            + std::to_string(iso) + " differs by up to "
                            + rounded_text(100 * spread)
                            + " % between files: their mean is used");
    }
    note_isos(noise, notes);
    return noise;
}

std::optional<DigitalGain> measured_digital_gain(const std::vector<DngMetadata>& files)
{
    std::vector<double> gains;
    for (const DngMetadata& file : files)
        if (const auto stops = file.baseline_exposure; stops && std::abs(*stops) < 10.0)
            gains.push_back(std::exp2(*stops));
    if (gains.empty())
        return std::nullopt;
    const double mean = mean_of(gains);
    double squares = 0.0;
    for (const double gain : gains)
        squares += (gain - mean) * (gain - mean);
    return DigitalGain { mean, std::sqrt(squares / double(gains.size())) };
}

NeutralDistribution merged_neutrals(const std::vector<DngMetadata>& files, Notes& notes)
{
    if (files.front().cfa.is_mono())
        return {};
    std::vector<std::array<double, 2>> neutrals;
    for (const DngMetadata& file : files)
        if (const auto& neutral = file.as_shot_neutral)
            neutrals.push_back({ (*neutral)[0], (*neutral)[2] });
    const NeutralDistribution result = distribution_of(neutrals);
    if (result.hull.empty())
        notes.push_back(
            std::string(
                "fewer than 3 distinct neutrals (or all on one line): sample:n ")
            + (files.front().calibrations.size() == 2
                   ? "walks along the Planckian locus between the calibration"
                     " illuminants instead; give files shot in more lights"
                   : "has nothing to draw from, as there is one matrix; name an"
                     " illuminant, or give files shot in more lights"));
    return result;
}

} // namespace cg2raw

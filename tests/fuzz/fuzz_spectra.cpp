// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/spectral_image.h"
#include "targets.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>

namespace cg2raw::test {
namespace {

/// Channels of an image: their names, and what its attributes say of them.
struct Channels {
    std::vector<std::string> names;
    std::map<std::string, double> metres;
    std::map<std::string, std::string> responses;
};

/// A line is a channel: its name, and after tabs its wavelength in m and its response.
Channels channels_of(std::string_view bytes)
{
    Channels all;
    std::istringstream lines { std::string(bytes) };
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string name, metres, response;
        std::getline(words, name, '\t');
        all.names.push_back(name);
        if (std::getline(words, metres, '\t') && !metres.empty())
            all.metres[name] = std::strtod(metres.c_str(), nullptr);
        if (std::getline(words, response))
            all.responses[name] = response;
    }
    return all;
}

template <class Value> auto lookup(const std::map<std::string, Value>& stated)
{
    return [&](const std::string& name) {
        const auto found = stated.find(name);
        return found == stated.end() ? std::nullopt : std::optional(found->second);
    };
}

void check_bins(const SpectralChannels& bins, std::size_t channels)
{
    const auto& nm = bins.wavelengths;
    if (nm.size() < 2 || nm.size() > channels || bins.channels.size() != nm.size())
        throw Finding("bins that are not as many as they may be");
    if (!std::is_sorted(nm.begin(), nm.end(), std::less_equal<>()))
        throw Finding("wavelengths do not rise");
    if (!bins.responses.empty() && bins.responses.size() != nm.size())
        throw Finding("responses of some bins");
}

/// A sensor of three lobes that sees the bins.
void use_bins(const SpectralChannels& bins)
{
    SensorProfile profile {};
    profile.id = "fuzz";
    const std::vector<double> nm { 380, 400, 420, 440, 460, 480, 500,
                                   520, 540, 560, 580, 600, 620, 640,
                                   660, 680, 700, 720, 740, 760, 780 };
    SpectralSensitivities sensitivities { nm, {} };
    for (std::size_t i = 0; i < nm.size(); ++i)
        sensitivities.rgb.push_back({ double(i), 1.0, double(nm.size() - i) });
    profile.spectral_sensitivities = sensitivities;
    try {
        const SpectralResponse response(profile, { { 300, 800 }, { 1, 2 } }, bins, 100);
        for (const Vec3& bin : response.per_bin())
            for (double value : bin)
                if (!std::isfinite(value))
                    throw Finding("camera RGB of a bin is not finite");
    } catch (const Error&) { // bins that the sensor does not see
    }
}

} // namespace

bool fuzz_spectra(std::string_view bytes)
{
    const Channels all = channels_of(bytes);
    std::optional<SpectralChannels> bins;
    const auto read = [&] {
        try {
            bins = spectral_channels(all.names, lookup(all.metres),
                                     lookup(all.responses));
        } catch (const Error& error) {
            throw Error(std::string("fuzz.exr: ") + error.what());
        }
    };
    if (!bounded(read, bytes.size(), spectra_memory, "fuzz.exr") || !bins)
        return false;
    check_bins(*bins, all.names.size());
    use_bins(*bins);
    return true;
}

} // namespace cg2raw::test

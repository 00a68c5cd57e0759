// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Which channels are bins of a spectrum, by their names.
#include "cg2raw/spectral_image.h"

#include "spectrum_text.h"
#include "text.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace cg2raw {
namespace {

struct Bin {
    double wavelength;
    int channel;
};

/// Bins of radiance, and whether there are reflectances.
struct Found {
    std::vector<Bin> bins;
    bool reflectance = false;
};

Found bins_among(const std::vector<std::string>& names, const StatedWavelength& stated)
{
    Found found;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::string_view name = names[i];
        std::optional<double> nm;
        if (name.substr(0, 3) == "S0.")
            nm = wavelength_of(name.substr(3), ',');
        else if (name.substr(0, 2) == "T.")
            found.reflectance |= wavelength_of(name.substr(2), ',').has_value();
        else if (const auto metres = stated(names[i]))
            nm = 1e9 * *metres;
        if (nm && !(*nm >= shortest_of_channels && *nm <= longest_of_channels))
            throw Error("channel " + names[i] + " has a wavelength of " + number(*nm)
                        + " nm; it must be " + number(shortest_of_channels) + " to "
                        + number(longest_of_channels) + " nm");
        if (nm)
            found.bins.push_back({ *nm, int(i) });
    }
    return found;
}

/// The responses that channels state, as their attributes say them; none if none does.
std::vector<Spectrum> responses_of(const std::vector<int>& channels,
                                   const std::vector<std::string>& names,
                                   const StatedResponse& stated)
{
    std::vector<Spectrum> responses;
    const std::string* without = nullptr;
    for (int channel : channels) {
        const std::string& name = names[std::size_t(channel)];
        if (const auto text = stated(name)) {
            try {
                responses.push_back(spectrum_from_text(*text));
            } catch (const Error& error) {
                throw Error("attribute " + name
                            + ", the response of that channel: " + error.what());
            }
        } else if (!without) {
            without = &name;
        }
    }
    if (!responses.empty() && without)
        throw Error("channel " + *without
                    + " states no response, which others do (attributes of the "
                      "channels' names): state all of them, or none");
    return responses;
}

} // namespace

std::optional<SpectralChannels> spectral_channels(const std::vector<std::string>& names,
                                                  const StatedWavelength& stated,
                                                  const StatedResponse& response)
{
    auto [bins, reflectance] = bins_among(names, stated);
    if (bins.empty() && reflectance)
        throw Error(
            "its spectrum is a reflectance (channels T.), not light: render it, "
            "or multiply it by the power of a light and call the channels S0.; its RGB "
            "picture alone is taken after oiiotool --ch R,G,B");
    if (bins.empty())
        return std::nullopt;
    std::sort(bins.begin(), bins.end(), [](const Bin& a, const Bin& b) {
        return std::pair(a.wavelength, a.channel) < std::pair(b.wavelength, b.channel);
    });
    SpectralChannels result;
    for (const auto& [nm, channel] : bins) {
        if (!result.wavelengths.empty() && !(nm > result.wavelengths.back()))
            throw Error("channels " + names[std::size_t(result.channels.back())]
                        + " and " + names[std::size_t(channel)]
                        + " are of one wavelength; leave one of them out");
        result.wavelengths.push_back(nm);
        result.channels.push_back(channel);
    }
    if (bins.size() < 2)
        throw Error("channel " + names[std::size_t(bins[0].channel)]
                    + " is the only bin of its spectrum; at least two are needed");
    if (response)
        result.responses = responses_of(result.channels, names, response);
    return result;
}

} // namespace cg2raw

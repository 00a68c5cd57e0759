// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Which channels are bins of a spectrum, by their names.
#include "cg2raw/spectral_image.h"

#include "text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

namespace cg2raw {
namespace {

constexpr double light_speed = 299792458.0; // m/s
constexpr double shortest = 1.0, longest = 1e6; // nm
constexpr std::size_t longest_number = 40; ///< characters

struct Prefix {
    std::string_view name;
    double factor;
};

/// SI prefixes of the layout; the longer name first.
constexpr std::array<Prefix, 17> prefixes { {
    { "da", 1e1 },
    { "Y", 1e24 },
    { "Z", 1e21 },
    { "E", 1e18 },
    { "P", 1e15 },
    { "T", 1e12 },
    { "G", 1e9 },
    { "M", 1e6 },
    { "k", 1e3 },
    { "h", 1e2 },
    { "d", 1e-1 },
    { "c", 1e-2 },
    { "m", 1e-3 },
    { "u", 1e-6 },
    { "n", 1e-9 },
    { "p", 1e-12 },
    { "", 1.0 },
} };

bool ends_with(std::string_view text, std::string_view ending)
{
    return text.size() >= ending.size()
        && text.substr(text.size() - ending.size()) == ending;
}

/// The number of "550,5" or "5,5e-7"; NaN if it is none. Its comma is a decimal point.
double number_before_unit(std::string_view text)
{
    if (text.empty() || text.size() > longest_number
        || text.find_first_not_of("0123456789,eE+-") != text.npos)
        return std::nan("");
    std::string digits(text);
    std::replace(digits.begin(), digits.end(), ',', '.');
    return parsed_number(digits);
}

/// nm of "550,0nm", "5,5e-7m" or "545THz"; nothing for other words.
std::optional<double> wavelength_of(std::string_view word)
{
    const bool is_frequency = ends_with(word, "Hz");
    if (!is_frequency && !ends_with(word, "m"))
        return std::nullopt;
    word.remove_suffix(is_frequency ? 2 : 1);
    for (const auto& [name, factor] : prefixes) {
        if (!ends_with(word, name))
            continue;
        const double value
            = number_before_unit(word.substr(0, word.size() - name.size())) * factor;
        const double nm = 1e9 * (is_frequency ? light_speed / value : value);
        if (nm >= shortest && nm <= longest)
            return nm;
    }
    return std::nullopt;
}

struct Bin {
    double wavelength;
    int channel;
};

/// Bins of radiance, and whether there are reflectances.
struct Found {
    std::vector<Bin> bins;
    bool reflectance = false;
};

Found bins_among(const std::vector<std::string>& names,
                 const std::function<std::optional<double>(const std::string&)>& stated)
{
    Found found;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::string_view name = names[i];
        std::optional<double> nm;
        if (name.substr(0, 3) == "S0.")
            nm = wavelength_of(name.substr(3));
        else if (name.substr(0, 2) == "T.")
            found.reflectance |= wavelength_of(name.substr(2)).has_value();
        else if (const auto metres = stated(names[i]))
            nm = 1e9 * *metres;
        if (nm && !(*nm >= shortest && *nm <= longest))
            throw Error("channel " + names[i] + " has a wavelength of "
                        + ::cg2raw::number(*nm) + " nm; it must be "
                        + ::cg2raw::number(shortest) + " to "
                        + ::cg2raw::number(longest) + " nm");
        if (nm)
            found.bins.push_back({ *nm, int(i) });
    }
    return found;
}

} // namespace

std::optional<SpectralChannels> spectral_channels(
    const std::vector<std::string>& names,
    const std::function<std::optional<double>(const std::string&)>& stated)
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
    return result;
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file CFA patterns by name, and what profiles say of their sites.
#include "cfa.h"

#include "text.h"

#include <algorithm>

namespace cg2raw {
namespace {

constexpr std::string_view letters = "rgb"; ///< by colour
constexpr const char* allowed
    = "RGGB, GRBG, GBRG or BGGR, or the 16 or 36 letters of a 4 x 4 or 6 x 6 repeat, "
      "row by row from the top-left active pixel, R, G and B each at least once, or "
      "mono";
constexpr const char* mono = "mono";
constexpr std::uint8_t green = 1;

bool bayer(const std::string& word)
{
    return word == "rggb" || word == "grbg" || word == "gbrg" || word == "bggr";
}

bool has_each_color(const std::string& word)
{
    return std::all_of(letters.begin(), letters.end(),
                       [&](char c) { return word.find(c) != std::string::npos; });
}

/// Side of the repeat that @p word spells; 0 if it spells none.
int side_of(const std::string& word)
{
    if (word.size() == 4)
        return bayer(word) ? 2 : 0;
    const int side = word.size() == 16 ? 4 : word.size() == 36 ? 6 : 0;
    const bool spelt = word.find_first_not_of(letters) == std::string::npos;
    return spelt && has_each_color(word) ? side : 0;
}

bool is_x_trans(const std::string& word)
{
    return word == "x-trans" || word == "xtrans" || word == "x_trans"
        || word == "x trans";
}

/// Its letters, or its sides where the letters alone would mislead.
std::string shown(const CfaPattern& cfa)
{
    return name_of(cfa) + " (" + std::to_string(cfa.height) + " x "
        + std::to_string(cfa.width) + ")";
}

} // namespace

CfaPattern cfa_from_name(std::string_view name)
{
    const std::string word = lower_case(name);
    if (word == mono)
        return mono_cfa();
    const int side = side_of(word);
    if (side == 0)
        throw Error("cfa \"" + std::string(name) + "\" must be " + allowed
                    + (is_x_trans(word)
                           ? "; its phase differs between X-Trans bodies: spell it out"
                           : ""));
    CfaPattern cfa;
    cfa.width = cfa.height = side;
    for (std::size_t i = 0; i < word.size(); ++i)
        cfa.colors[i] = std::uint8_t(letters.find(word[i]));
    return cfa;
}

CfaPattern mono_cfa()
{
    CfaPattern cfa { 1, 1, {} };
    cfa.colors[0] = green;
    return cfa;
}

std::string name_of(const CfaPattern& cfa)
{
    if (cfa.is_mono())
        return "MONO";
    std::string name;
    for (int site = 0; site < cfa.sites(); ++site)
        name += "RGB"[cfa.colors[std::size_t(site)]];
    return name;
}

void check_cfa(const CfaPattern& cfa)
{
    if (cfa.is_mono() && cfa.colors[0] == green)
        return;
    const int side = side_of(lower_case(name_of(cfa)));
    if (cfa.width != side || cfa.height != side)
        throw Error("cfa " + shown(cfa) + " must be " + allowed);
}

std::vector<double> spread_over_sites(const std::vector<double>& numbers,
                                      const CfaPattern& cfa)
{
    const std::size_t sites = std::size_t(cfa.sites());
    if (numbers.size() == sites)
        return numbers;
    if (cfa.is_mono())
        throw Error("must be 1 number, since a monochrome sensor has one CFA site, not "
                    + std::to_string(numbers.size()));
    if (numbers.size() != 1 && numbers.size() != 3)
        throw Error("must be 1 number (all CFA sites), 3 (R, G, B) or "
                    + std::to_string(sites) + " (one per CFA site), not "
                    + std::to_string(numbers.size()));
    std::vector<double> result;
    for (std::size_t site = 0; site < sites; ++site)
        result.push_back(numbers[numbers.size() == 1 ? 0 : cfa.colors[site]]);
    return result;
}

std::vector<double> fewest_numbers(const std::vector<double>& sites,
                                   const CfaPattern& cfa)
{
    std::vector<double> numbers { sites.front() };
    if (spread_over_sites(numbers, cfa) == sites)
        return numbers;
    numbers.assign(3, 0.0);
    for (std::size_t site = 0; site < sites.size(); ++site)
        numbers[cfa.colors[site]] = sites[site];
    return spread_over_sites(numbers, cfa) == sites ? numbers : sites;
}

} // namespace cg2raw

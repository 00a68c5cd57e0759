// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file effect.h: laws that every registered effect obeys by itself.
#include "effect_block.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace cg2raw::test {
namespace {

constexpr Size frame { 71, 53 };

/// Draws, or states the prediction, with the same numbers for every block.
void run(const Effect& effect, bool drawn, const Values& values, EffectBlock& block)
{
    if (drawn)
        effect.draw(block.signal, values, Rng(5, effect.name, 1));
    else
        effect.predict(block.signal, values);
}

std::vector<float> result(const Effect& effect, bool drawn, const Values& values)
{
    EffectBlock block(effect, frame, { 0, 0 }, frame);
    run(effect, drawn, values, block);
    return block.all();
}

/// Both ways where there are both: false is predict, true is draw.
std::vector<bool> ways(const Effect& effect)
{
    return effect.draw ? std::vector<bool> { false, true }
                       : std::vector<bool> { false };
}

class EffectLaws : public testing::TestWithParam<std::string> {
protected:
    const Effect& tested() const { return effect(GetParam()); }
};

std::vector<std::string> names()
{
    std::vector<std::string> all;
    for (const Effect& effect : all_effects())
        all.push_back(effect.name);
    return all;
}

INSTANTIATE_TEST_SUITE_P(Registered, EffectLaws, testing::ValuesIn(names()),
                         [](const auto& test) { return test.param; });

TEST_P(EffectLaws, NullIsIdentityBitForBit)
{
    const std::vector<float> before
        = EffectBlock(tested(), frame, { 0, 0 }, frame).all();
    for (bool drawn : ways(tested()))
        EXPECT_EQ(result(tested(), drawn, null_values(tested())), before) << drawn;
}

TEST_P(EffectLaws, TheResultIsFiniteWithinBounds)
{
    for (bool drawn : ways(tested()))
        for (bool least : { false, true }) {
            Values values;
            for (const Parameter& parameter : tested().parameters)
                values.push_back(least ? parameter.min : parameter.max);
            for (float value : result(tested(), drawn, values))
                ASSERT_TRUE(std::isfinite(value)) << drawn << least;
        }
}

/// The interior of a block whose halo is the effect's reach.
TEST_P(EffectLaws, ABlockWithItsHaloIsAPieceOfTheFrame)
{
    const Values values = strong_values(tested());
    const int reach = tested().reach;
    const Site origin { 7, 10 };
    const Size size { 9 + 2 * reach, 6 + 2 * reach };
    ASSERT_LE(origin.row + size.height, frame.height);
    for (bool drawn : ways(tested())) {
        EffectBlock whole(tested(), frame, { 0, 0 }, frame);
        EffectBlock block(tested(), frame, origin, size);
        run(tested(), drawn, values, whole);
        run(tested(), drawn, values, block);
        for (int row = reach; row < size.height - reach; ++row)
            for (int col = reach; col < size.width - reach; ++col)
                ASSERT_EQ(block.at({ row, col }),
                          whole.at({ origin.row + row, origin.col + col }))
                    << drawn << " " << row << " " << col;
    }
}

/// A block at the frame's edges needs no halo there: the mirror is the frame's.
TEST_P(EffectLaws, ABlockInTheCornerIsThatOfTheFrame)
{
    const Values values = strong_values(tested());
    const int reach = tested().reach;
    const Size size { 12 + reach, 8 + reach };
    const Site corner { frame.height - size.height, frame.width - size.width };
    EffectBlock whole(tested(), frame, { 0, 0 }, frame);
    EffectBlock block(tested(), frame, corner, size);
    run(tested(), false, values, whole);
    run(tested(), false, values, block);
    for (int row = reach; row < size.height; ++row)
        for (int col = reach; col < size.width; ++col)
            ASSERT_EQ(block.at({ row, col }),
                      whole.at({ corner.row + row, corner.col + col }))
                << row << " " << col;
}

/// What stands for the others while one parameter leaves null: null, unless they are
/// its strength. Tukey's lambda leaves its null without outliers: with them, the null
/// is drawn as a normal.
Values others_of(const Effect& effect, const std::string& parameter)
{
    Values values = null_values(effect);
    for (const char* name :
         { "hot_pixels", "heavy_tailed_noise", "bias_structure", "amplifier_glow",
           "dark_current_nonuniformity", "random_telegraph_noise", "dust" })
        if (effect.name == name)
            values = strong_values(effect);
    if (parameter == "tukey_lambda")
        values[values.size() - 2] = 0.0; // outlier_fraction
    if (effect.name == "blur")
        values[1] = 0.1; // ring_2; the scales are of the rings
    return values;
}

/// Departure of each pixel's value from that at null.
std::vector<double> response(const Effect& effect, bool drawn, std::size_t parameter,
                             double step)
{
    Values values = others_of(effect, effect.parameters[parameter].name);
    values[parameter] = effect.parameters[parameter].null;
    std::vector<float> before = result(effect, drawn, values);
    values[parameter] += step;
    const std::vector<float> after = result(effect, drawn, values);
    std::vector<double> difference;
    for (std::size_t i = 0; i < before.size(); ++i)
        difference.push_back(double(after[i]) - double(before[i]));
    return difference;
}

double norm(const std::vector<double>& values)
{
    double sum = 0.0;
    for (double value : values)
        sum += value * value;
    return std::sqrt(sum);
}

/// How far two steps are from twice one, relatively; 1 if there is no response.
double departure_from_a_line(const Effect& effect, bool drawn, std::size_t parameter)
{
    const double step = 1e-3 * way(effect.parameters[parameter]);
    const auto once = response(effect, drawn, parameter, step);
    auto twice = response(effect, drawn, parameter, 2.0 * step);
    const double length = norm(twice);
    if (length == 0.0)
        return 1.0;
    for (std::size_t i = 0; i < once.size(); ++i)
        twice[i] -= 2.0 * once[i];
    return norm(twice) / length;
}

/// Their response is none of the first order: a rounding's variance grows with the
/// square of its step; a level acts on what is above it; more pixels are hot, each more
/// so; more draws are outliers; what lies above white counts as white as soon as any of
/// it is blended; what fades over no distance is none; a correlation of noise is none
/// by itself, nor is a wave without an amplitude.
const std::set<std::string> not_linear { "quantisation.step",
                                         "full_well.below_white",
                                         "hot_pixels.fraction",
                                         "heavy_tailed_noise.outlier_fraction",
                                         "noise_reduction.blend",
                                         "noise_reduction.diagonal",
                                         "bias_structure.edge_length",
                                         "amplifier_glow.extent",
                                         "read_noise_correlation.coefficient",
                                         "mains_flicker.period",
                                         "pdaf_pixels.pitch",
                                         "pdaf_pixels.row",
                                         "pdaf_pixels.column",
                                         "dust.density",
                                         "dust.radius" };

TEST_P(EffectLaws, TheResponseIsOfTheFirstOrderAtNull)
{
    for (std::size_t i = 0; i < tested().parameters.size(); ++i) {
        const std::string name = tested().name + "." + tested().parameters[i].name;
        double least = 1.0;
        for (bool drawn : ways(tested()))
            least = std::min(least, departure_from_a_line(tested(), drawn, i));
        if (not_linear.count(name))
            EXPECT_GT(least, 0.05) << name << ": it is linear, take it off the list";
        else
            EXPECT_LT(least, 0.05) << name;
    }
}

} // namespace
} // namespace cg2raw::test

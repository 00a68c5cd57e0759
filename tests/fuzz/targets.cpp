// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "targets.h"

#include "counted_memory.h"

#include "cg2raw/effect.h"
#include "cg2raw/spectral_image.h"
#include "cg2raw/transform.h"

#include <algorithm>
#include <cmath>

namespace cg2raw::test {
namespace {

double largest_share = 0.0;

void check_memory(const MemoryMeter& meter, std::size_t size, MemoryBound bound)
{
    const std::size_t allowed = bound.fixed + bound.times_the_file * size;
    largest_share = std::max(largest_share, double(meter.most()) / double(allowed));
    if (meter.most() > allowed)
        throw Finding(std::to_string(size) + " bytes made the reader hold "
                      + std::to_string(meter.most()) + ", more than "
                      + std::to_string(allowed));
}

/// Runs @p step, which may refuse what it is given.
template <class Step> void try_step(const Step& step)
{
    try {
        step();
    } catch (const Error&) {
    }
}

template <class Numbers> void expect_finite(const Numbers& numbers, const char* what)
{
    for (double value : numbers)
        if (!std::isfinite(value))
            throw Finding(std::string(what) + " is not finite");
}

void use_noise(const SensorProfile& profile, double iso)
{
    try_step([&] {
        const NoiseAtIso noise = noise_at(profile, iso);
        expect_finite(noise.beta1, "beta1");
        expect_finite(noise.beta2, "beta2");
        if (noise.shape)
            expect_finite(std::array<double, 2> { noise.shape->tukey_lambda,
                                                  noise.shape->row_sigma },
                          "the shape of noise");
        if (noise.shape && noise.shape->outliers)
            expect_finite(
                std::array<double, 2> { noise.shape->outliers->fraction,
                                        noise.shape->outliers->variance_ratio },
                "outliers");
    });
}

void use_spectra(const SensorProfile& profile)
{
    const SpectralChannels bins { { 0, 1, 2 }, { 400, 500, 640 } };
    try_step([&] {
        const Spectrum light = spectrum_of(profile, illuminant(profile, "D65")).power;
        const SpectralResponse response(profile, light, bins, 100);
        for (const Vec3& bin : response.per_bin())
            expect_finite(bin, "camera RGB of a bin");
    });
}

} // namespace

bool bounded(const std::function<void()>& read, std::size_t size, MemoryBound bound,
             const std::string& name)
{
    const MemoryMeter meter;
    try {
        read();
    } catch (const Error& error) {
        check_memory(meter, size, bound);
        const std::string message = error.what();
        check_message(message);
        if (message.rfind(name + ": ", 0) != 0)
            throw Finding("an Error does not name the file: " + message);
        return false;
    }
    check_memory(meter, size, bound);
    return true;
}

void check_message(const std::string& message)
{
    const auto is_control = [](unsigned char c) { return c < 0x20 || c == 0x7f; };
    if (message.empty() || message.size() > 2000
        || std::any_of(message.begin(), message.end(), is_control))
        throw Finding(std::to_string(message.size())
                      + " bytes that are no line of a message: " + message);
}

void use_light(const SensorProfile& profile, const char* spec)
{
    try_step([&] {
        const Illuminant light = illuminant(profile, spec);
        expect_finite(light.neutral, "a neutral");
        for (Convention convention : { Convention::dng, Convention::paper })
            try_step([&] {
                const auto transform = camera_from_scene(profile, light, convention);
                if (convention == Convention::dng)
                    expect_finite(transform.first.m, "camera_from_scene");
                expect_finite(transform.gains, "a gain of the white balance");
            });
        try_step([&] {
            const auto uplift
                = camera_from_scene(profile, light, Convention::spectral).uplift;
            for (const auto& row : *uplift)
                expect_finite(row, "a matrix of terms");
        });
        try_step([&] { srgb_from_balanced(profile, light); });
    });
}

void use(const SensorProfile& profile)
{
    const std::string json = to_json(profile);
    std::string again;
    try {
        again = to_json(parse_profile(json, "again.json"));
    } catch (const Error& error) {
        throw Finding(std::string("what was written is refused: ") + error.what());
    }
    if (again != json)
        throw Finding("what was written reads back as something else");
    for (const NoiseAtIso& row : profile.noise)
        for (double stops : { -1.1, -1.0, 0.0, 0.3, 1.0 })
            use_noise(profile, row.iso * std::exp2(stops));
    for (const char* light :
         { "sample:3", "A", "D65", "25000K", "neutral:0.5:0.6", "FL2", "lamp:x" })
        use_light(profile, light);
    use_spectra(profile);
    try_step([&] {
        for (const EffectSetting& setting : profile.effects)
            values_of(effect(setting.name), setting.parameters, profile.cfa,
                      "again.json");
    });
}

double most_of_bound() { return largest_share; }

} // namespace cg2raw::test

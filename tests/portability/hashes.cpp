// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Hashes of what each sensor, noise and effect makes of one scene, float by
/// float and as DNG. Builds of all compilers, levels of optimisation and machines must
/// print the lines of hashes.txt.
#include "cg2raw/dng_writer.h"
#include "cg2raw/frame.h"

#include "platform/paths.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>

namespace {

using namespace cg2raw;

constexpr Size size { 192, 128 };

/// FNV-1a, 64 bits. Source: Fowler, Noll, Vo.
std::uint64_t hash_of(const void* data, std::size_t bytes)
{
    std::uint64_t hash = 14695981039346656037u;
    for (std::size_t i = 0; i < bytes; ++i)
        hash = (hash ^ static_cast<const unsigned char*>(data)[i]) * 1099511628211u;
    return hash;
}

/// Colours from black to beyond white, none of them twice.
std::vector<float> scene()
{
    std::vector<float> pixels;
    for (int row = 0; row < size.height; ++row)
        for (int col = 0; col < size.width; ++col)
            for (int c = 0; c < 3; ++c)
                pixels.push_back(float(col * 7 + row * 3 + c * ((row * col) % 61))
                                 / float(1 << 11));
    return pixels;
}

const std::vector<float> pixels = scene();
const RgbView view { pixels.data(), size.width, size.height, 3, 3 * size.width };

std::vector<std::string> lines;

void add(const std::string& name, const char* kind, std::uint64_t hash)
{
    char text[20];
    std::snprintf(text, sizeof text, "%016llx ", static_cast<unsigned long long>(hash));
    lines.push_back(text + std::string(kind) + " " + name);
}

std::uint64_t hash_of_file(const std::string& path)
{
    std::ifstream file(path_of(path), std::ios::binary);
    const std::string bytes { std::istreambuf_iterator<char>(file), {} };
    return hash_of(bytes.data(), bytes.size());
}

/// One run of a profile: its signal, what is predicted of it, and its file.
void hash_run(const std::string& name, const SensorProfile& profile, const Run& run,
              const std::string& path)
{
    const Simulation simulation(profile, run, size);
    const auto threads = parallel_threads(2);
    const auto rows = [](int first, int count, std::vector<float>&) {
        return RgbView { view.data + std::ptrdiff_t(first) * view.row_stride,
                         view.width, count, view.pixel_stride, view.row_stride };
    };
    const std::size_t count = std::size_t(size.width) * size.height;
    std::vector<float> mean(count), variance(count);
    const auto plane = [](std::vector<float>& of) {
        return Plane<float> { of.data(), size.width, size.height, size.width };
    };
    simulate(rows, simulation, plane(mean), threads);
    add(name, "signal", hash_of(mean.data(), count * sizeof(float)));
    predict(rows, simulation, plane(mean), plane(variance), threads);
    add(name, "mean", hash_of(mean.data(), count * sizeof(float)));
    add(name, "variance", hash_of(variance.data(), count * sizeof(float)));
    const RawFrame frame = simulate(view, simulation, threads);
    const DngOptions options;
    write_dng(path, { frame.dn.data(), frame.width, frame.height, frame.width },
              describe(simulation, options, Shot()), options);
    add(name, "dng", hash_of_file(path));
}

/// As it is bundled: lights, and each ISO, half way to the next, and one stop beyond.
void hash_profile(const SensorProfile& profile, const std::string& path)
{
    for (const char* illuminant : { "D50", "3200K", "sample:7", "xy:0.35:0.36" }) {
        Run run;
        run.illuminant = illuminant;
        hash_run(profile.id + " " + illuminant, profile, run, path);
    }
    for (const NoiseAtIso& row : profile.noise) {
        const bool one = profile.noise.size() == 1;
        for (const double stops : { 1.0, 1.41 }) {
            const double iso = one ? row.iso : row.iso * stops;
            Run run;
            run.illuminant = "D65";
            run.iso = iso;
            run.seed = 11;
            hash_run(profile.id + " ISO " + std::to_string(int(iso)), profile, run,
                     path);
            if (!row.shape)
                continue;
            run.noise_model = NoiseModel::physical;
            run.sample_digital_gain = profile.digital_gain.has_value();
            hash_run(profile.id + " physical " + std::to_string(int(iso)), profile, run,
                     path);
        }
    }
}

/// An effect alone, each parameter a twentieth of its range from null.
void hash_effect(SensorProfile profile, const Effect& effect, const std::string& path)
{
    EffectSetting setting { effect.name, {}, {} };
    for (const Parameter& parameter : parameters_of(effect, profile.cfa, "hashes")) {
        const double edge
            = parameter.null < parameter.max ? parameter.max : parameter.min;
        const double value = parameter.null + (edge - parameter.null) / 20;
        setting.parameters[parameter.name]
            = parameter.whole ? double(int(value)) : value;
    }
    profile.effects = { setting };
    Run run;
    run.illuminant = "D55";
    run.exposure_time = 0.02;
    try {
        check(profile, effect.name);
    } catch (const Error&) {
        lines.push_back("no setting of " + effect.name);
        return;
    }
    hash_run(effect.name, profile, run, path);
}

void hash_all(const std::string& folder, const std::string& path)
{
    for (const char* id : { "nikon-d40", "fujifilm-x-m1", "samsung-s20fe",
                            "sony-a7s-ii", "canon-5d-mark-iv", "gopro-hero6-black" })
        hash_profile(load_profile(folder + "/" + id + ".json"), path);
    const SensorProfile bayer = load_profile(folder + "/nikon-d850.json");
    for (const Effect& effect : all_effects())
        hash_effect(bayer, effect, path);
}

/// Prints what differs from the table. Windows may have its line ends.
int compare_with(const std::string& table)
{
    std::ifstream file(path_of(table));
    std::vector<std::string> expected;
    for (std::string line; std::getline(file, line);)
        expected.push_back(line.substr(0, line.find('\r')));
    std::size_t differ = 0;
    for (std::size_t i = 0; i < std::max(lines.size(), expected.size()); ++i) {
        const std::string ours = i < lines.size() ? lines[i] : "(no line)";
        const std::string theirs = i < expected.size() ? expected[i] : "(no line)";
        if (ours != theirs && ++differ <= 40)
            std::printf("%s, and %s has %s\n", ours.c_str(), table.c_str(),
                        theirs.c_str());
    }
    std::printf("%zu hashes, %zu differ\n", lines.size(), differ);
    return differ == 0 && !expected.empty() ? 0 : 1;
}

} // namespace

int main(int argc, char** argv)
{
    if (argc != 3 && argc != 4) {
        std::fputs("hashes PROFILES FILE.dng [TABLE]: prints all, or what differs from "
                   "those of a table\n",
                   stderr);
        return 2;
    }
    try {
        hash_all(argv[1], argv[2]);
    } catch (const Error& error) {
        std::fprintf(stderr, "hashes: %s\n", error.what());
        return 1;
    }
    if (argc == 4)
        return compare_with(argv[3]);
    for (const std::string& line : lines)
        std::printf("%s\n", line.c_str());
    return 0;
}

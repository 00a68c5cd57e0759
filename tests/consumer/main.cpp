// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A grey ramp -> RAW -> DNG, with nothing but the installed headers and
/// libraries.
#include <cg2raw/dng_reader.h>
#include <cg2raw/dng_writer.h>
#include <cg2raw/frame.h>

#include <cstdio>
#include <vector>

namespace {

std::vector<float> grey_ramp(cg2raw::Size size)
{
    std::vector<float> pixels;
    for (int row = 0; row < size.height; ++row)
        for (int col = 0; col < size.width; ++col)
            pixels.insert(pixels.end(), 3, float(col) / float(size.width - 1));
    return pixels;
}

} // namespace

int main(int argc, char** argv)
{
    using namespace cg2raw;
    if (argc != 2)
        return 2;
    try {
        const SensorProfile profile = load_profile(PROFILES "/nikon-d40.json");
        const Size size { 64, 48 };
        Run run;
        run.illuminant = "D65";
        const Simulation simulation(profile, run, size);
        const std::vector<float> scene = grey_ramp(size);
        const RgbView view { scene.data(), size.width, size.height, 3, 3 * size.width };
        const RawFrame frame = simulate(view, simulation, parallel_threads(2));
        const DngOptions options;
        write_dng(argv[1], { frame.dn.data(), frame.width, frame.height, frame.width },
                  describe(simulation, options, Shot()), options);
        const DngMetadata written = read_dng_metadata(argv[1]);
        std::printf("%s %dx%d white %d\n", written.model.c_str(),
                    written.active_area.width, written.active_area.height,
                    written.white_level);
        return written.active_area.width == size.width
                && written.white_level == profile.white_level
            ? 0
            : 1;
    } catch (const Error& error) {
        std::fprintf(stderr, "consumer: %s\n", error.what());
        return 1;
    }
}

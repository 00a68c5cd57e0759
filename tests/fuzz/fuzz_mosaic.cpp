// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/dng_mosaic.h"
#include "targets.h"

#include <cmath>
#include <sstream>
#include <vector>

namespace cg2raw::test {
namespace {

/// What a host allocates by what open() says, and what reading takes beside it.
void read_all(DngMosaic& mosaic)
{
    const Size size = mosaic.storage().size;
    std::vector<std::uint16_t> dn(std::size_t(size.width) * std::size_t(size.height));
    mosaic.read_rows(0, { dn.data(), size.width, size.height, size.width });
}

void develop(DngMosaic& mosaic)
{
    DevelopedDng picture(mosaic);
    const Size size = picture.size();
    const std::ptrdiff_t pitch = 3 * std::ptrdiff_t(size.width);
    std::vector<float> rgb(std::size_t(pitch), 0.0F);
    for (int row = 0; row < size.height; ++row) {
        picture.read_rows(row, 1, rgb.data(), pitch);
        for (const float value : rgb)
            if (!std::isfinite(value))
                throw Finding("a pixel of the picture is not finite");
    }
}

} // namespace

bool fuzz_mosaic(std::string_view bytes)
{
    const std::string name = "fuzz.dng";
    std::istringstream stream { std::string(bytes) };
    std::unique_ptr<DngMosaic> mosaic;
    const auto limited = [&](const std::function<void()>& step) {
        return bounded(step, bytes.size(), mosaic_memory, name);
    };
    if (!limited([&] { mosaic = std::make_unique<DngMosaic>(stream, name); }))
        return false;
    if (!is_dng(stream))
        throw Finding("what can be read is no DNG");
    const bool whole = limited([&] { read_all(*mosaic); });
    limited([&] { develop(*mosaic); });
    return whole;
}

} // namespace cg2raw::test

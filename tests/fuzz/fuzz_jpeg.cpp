// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "jpeg/lossless.h"
#include "jpeg/lossless_decoder.h"
#include "targets.h"

#include <algorithm>

namespace cg2raw::test {
namespace {

/// Lines, and samples of a line, that the first SOF3 states; a reader of DNGs has these
/// from the DNG's tags.
Size stated_size(std::string_view jpeg)
{
    const std::size_t at = jpeg.find("\xff\xc3");
    if (at == jpeg.npos || jpeg.size() - at < 10)
        return { 1, 1 };
    const auto byte = [&](std::size_t i) { return int(std::uint8_t(jpeg[at + i])); };
    return { (byte(7) << 8 | byte(8)) * byte(9), byte(5) << 8 | byte(6) };
}

/// Samples of @p count, which held @p before; none if the JPEG is refused.
std::vector<std::uint16_t> decoded(const std::vector<std::uint8_t>& jpeg,
                                   std::uint64_t count, std::uint16_t before)
{
    std::vector<std::uint16_t> samples(count, before);
    const auto decode = [&] {
        try {
            decode_lossless_jpeg(jpeg, samples.data(), count);
        } catch (const Error& error) {
            throw Error("fuzz.jpg: " + std::string(error.what()));
        }
    };
    if (!bounded(decode, jpeg.size(), jpeg_memory, "fuzz.jpg"))
        samples.clear();
    return samples;
}

/// Our encoder makes a JPEG of any samples that our decoder gives back.
void encode_again(const std::vector<std::uint16_t>& samples, Size size,
                  Prediction prediction)
{
    const Size tile { size.width + size.width % 2, (size.height + 15) / 16 * 16 };
    JpegScratch scratch;
    std::vector<std::uint8_t> jpeg;
    encode_lossless_jpeg({ samples.data(), size.width, size.height, size.width }, tile,
                         { 2, 2 }, 16, prediction, scratch, jpeg);
    const auto again
        = decoded(jpeg, std::uint64_t(tile.width) * std::uint64_t(tile.height), 0);
    if (again.empty())
        throw Finding("what was encoded is refused");
    for (int row = 0; row < size.height; ++row)
        if (!std::equal(samples.begin() + std::ptrdiff_t(row) * size.width,
                        samples.begin() + std::ptrdiff_t(row + 1) * size.width,
                        again.begin() + std::ptrdiff_t(row) * tile.width))
            throw Finding("what was encoded decodes to something else");
}

} // namespace

bool fuzz_jpeg(std::string_view bytes)
{
    const Size size = stated_size(bytes);
    const std::uint64_t count = std::uint64_t(size.width) * std::uint64_t(size.height);
    if (count > most_jpeg_samples(bytes.size()))
        return false; // as the reader of DNGs has it
    const std::vector<std::uint8_t> jpeg(bytes.begin(), bytes.end());
    const auto samples = decoded(jpeg, count, 0);
    if (samples != decoded(jpeg, count, 0xffff))
        throw Finding("what is decoded depends on what was there before");
    if (samples.empty())
        return false;
    for (const Prediction prediction : { Prediction::left, Prediction::best })
        encode_again(samples, size, prediction);
    return true;
}

} // namespace cg2raw::test

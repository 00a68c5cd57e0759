// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Thousands of damaged DNGs: each is read or refused by an Error that names the
/// file, in bounded memory and a bounded number of reads. The sanitizers' build runs
/// the same.
#include "counted_memory.h"
#include "opcode_builder.h"
#include "reader/gain_maps.h"
#include "reader/metadata_parts.h"
#include "tiff_builder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <sstream>

namespace cg2raw::test {
namespace {

/// A read needs this much whatever the file, and this many times the file's size.
constexpr std::size_t fixed_memory = 64 * 1024, times_the_file = 8;
/// 32 directories may lie over each other.
constexpr std::size_t times_a_byte_is_read = 32;

/// A file in memory that counts the bytes which are taken out of it.
class CountedFile : public std::stringbuf {
public:
    using std::stringbuf::stringbuf;
    std::size_t taken() const { return m_taken; }

protected:
    std::streamsize xsgetn(char* to, std::streamsize count) override
    {
        const std::streamsize read = std::stringbuf::xsgetn(to, count);
        m_taken += std::size_t(read);
        return read;
    }

private:
    std::size_t m_taken = 0;
};

/// Reads what may be anything; true if it is a DNG. Fails the test on all but an Error.
bool survives(const std::string& bytes)
{
    CountedFile file(bytes);
    std::istream stream(&file);
    const MemoryMeter memory;
    bool is_dng = false;
    std::string message;
    try {
        const DngMetadata metadata = read_dng_stream(stream, "hostile.dng");
        is_dng = true;
        parse_profile(to_json(profile_from_dng(metadata)), "hostile.dng");
    } catch (const Error& error) {
        message = error.what();
        EXPECT_EQ(message.rfind("hostile.dng: ", 0), 0U) << message;
    }
    EXPECT_LE(memory.most(), fixed_memory + times_the_file * bytes.size()) << message;
    EXPECT_LE(file.taken(), times_a_byte_is_read * bytes.size()) << message;
    return is_dng;
}

void put(std::string& bytes, std::size_t at, std::uint64_t word, int size,
         bool big_endian)
{
    for (int i = 0; i < size && at + std::size_t(i) < bytes.size(); ++i)
        bytes[at + std::size_t(i)] = char(word >> 8 * (big_endian ? size - 1 - i : i));
}

std::uint64_t get(const std::string& bytes, std::size_t at, int size, bool big_endian)
{
    std::uint64_t word = 0;
    for (int i = 0; i < size; ++i)
        word = word << 8
            | static_cast<unsigned char>(
                   bytes[at + std::size_t(big_endian ? i : size - 1 - i)]);
    return word;
}

Ifd rich_dng()
{
    Ifd ifd = tiny_dng_with_sub_ifds();
    ifd.signed_rationals(50722, { 129, -37, -28, -72, 209, -6, -8, 27, 80 }, 128);
    ifd.signed_rationals(50723, { 128, 1, 0, 0, 128, 0, 0, 2, 125 }, 128);
    ifd.signed_rationals(50724, { 127, 0, 0, 0, 128, 0, 0, 0, 124 }, 128);
    ifd.signed_rationals(50964, { 74, 28, 21, 20, 108, 0, -2, -37, 145 }, 128);
    ifd.rationals(50727, { 2, 1, 1 }, 1).shorts(50779, { 17 });
    ifd.text(50931, "com.adobe").text(50932, "com.adobe").text(315, "Somebody");
    Ifd& raw = ifd.sub_ifds[1];
    raw.doubles(51041, { 1e-4, 2e-7 }).longs(50829, { 0, 0, 6, 8 });
    raw.signed_rationals(50715, std::vector<std::int64_t>(8, 1), 3);
    raw.signed_rationals(50716, std::vector<std::int64_t>(6, 1), 3);
    raw.shorts(50713, { 2, 2 }).rationals(50714, { 640, 641, 642, 643 }, 10);
    OpcodeBuilder shading { 5, 5 };
    raw.bytes(51009, opcode_list({ shading.gain_map(), { 8, 0, { 1, 2, 3 } } }));
    raw.bytes(51022, opcode_list({ { 1, 1, { 0, 0 } } }));
    return ifd;
}

class HostileDng : public testing::TestWithParam<std::tuple<bool, bool>> {
protected:
    bool big_endian() const { return std::get<0>(GetParam()); }
    std::string bytes() const
    {
        return file_of(std::get<1>(GetParam()) ? rich_dng() : tiny_dng(), big_endian());
    }

    /// Offsets of all 12-byte entries: the directory in the header and those it names.
    std::vector<std::size_t> entries() const
    {
        const std::string file = bytes();
        std::vector<std::size_t> found;
        std::vector<std::size_t> ifds { get(file, 4, 4, big_endian()) };
        for (std::size_t i = 0; i < ifds.size(); ++i)
            for (std::size_t n = 0; n < get(file, ifds[i], 2, big_endian()); ++n) {
                const std::size_t at = ifds[i] + 2 + 12 * n;
                found.push_back(at);
                const auto tag = get(file, at, 2, big_endian());
                const auto value = get(file, at + 8, 4, big_endian());
                if (tag == 34665)
                    ifds.push_back(value);
                for (std::size_t k = 0; tag == 330 && k < 2; ++k)
                    ifds.push_back(get(file, value + 4 * k, 4, big_endian()));
            }
        return found;
    }

    /// Every entry's word at @p offset of @p size bytes becomes each of @p words.
    void spoil_entries(std::size_t offset, int size,
                       const std::vector<std::uint64_t>& words)
    {
        const std::string whole = bytes();
        for (std::size_t at : entries())
            for (std::uint64_t word : words) {
                std::string file = whole;
                put(file, at + offset, word, size, big_endian());
                survives(file);
            }
    }
};

TEST_P(HostileDng, IsADngBeforeItIsSpoilt)
{
    EXPECT_TRUE(survives(bytes()));
    EXPECT_GT(entries().size(), std::get<1>(GetParam()) ? 40U : 15U);
}

TEST_P(HostileDng, TruncatedAtEveryByte)
{
    const std::string whole = bytes();
    int refused = 0;
    for (std::size_t size = 0; size < whole.size(); ++size)
        refused += survives(whole.substr(0, size)) ? 0 : 1;
    // The four bytes behind IFD0 point to the next directory, which nobody reads.
    EXPECT_EQ(refused, int(whole.size()) - 4);
}

TEST_P(HostileDng, Counts)
{
    spoil_entries(4, 4, { 0, 1, 2, 17, 65535, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF });
}

TEST_P(HostileDng, Types)
{
    std::vector<std::uint64_t> types { 255, 0x8000, 0xFFFF };
    for (std::uint64_t type = 0; type < 20; ++type)
        types.push_back(type);
    spoil_entries(2, 2, types);
}

TEST_P(HostileDng, Offsets)
{
    const std::uint64_t size = bytes().size();
    const std::uint64_t ifd0 = get(bytes(), 4, 4, big_endian());
    spoil_entries(8, 4,
                  { 0, 1, 8, ifd0, ifd0 + 2, size - 1, size, 0xFFFFFFFF, 0x80000000 });
}

TEST_P(HostileDng, EveryEntryIsEachTag)
{
    spoil_entries(0, 2, { 0, 254, 256, 330, 34665, 50713, 50714, 50721, 50829, 51041 });
}

TEST_P(HostileDng, ZeroDenominatorsAndOtherWords)
{
    const std::string whole = bytes();
    for (std::size_t at = 8; at + 4 <= whole.size(); ++at)
        for (std::uint64_t word :
             { 0ULL, 0xFFFFFFFFULL, 0x80000000ULL, 0x7FF00000ULL }) {
            std::string file = whole;
            put(file, at, word, 4, big_endian());
            survives(file);
        }
}

TEST_P(HostileDng, RandomBytes)
{
    const std::string whole = bytes();
    std::mt19937 random(20230413); // one seed: a failure can be repeated
    for (int round = 0; round < 20000; ++round) {
        std::string file = whole;
        for (unsigned n = random() % 8 + 1; n > 0; --n)
            file[random() % file.size()] = char(random());
        survives(file);
    }
}

INSTANTIATE_TEST_SUITE_P(Reader, HostileDng,
                         testing::Combine(testing::Bool(), testing::Bool()));

std::string error_of(const std::string& bytes)
{
    std::istringstream stream(bytes);
    try {
        read_dng_stream(stream, "hostile.dng");
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

TEST(HostileDng, MessagesSayWhatReachesBeyondTheFile)
{
    std::string file = file_of(tiny_dng());
    const std::size_t ifd0 = get(file, 4, 4, false);
    EXPECT_NE(
        error_of(file.substr(0, ifd0 + 50)).find("entries reaches beyond the file's"),
        std::string::npos);
    for (std::size_t at = ifd0 + 2; get(file, at, 2, false) <= 50721; at += 12)
        if (get(file, at, 2, false) == 50721)
            put(file, at + 8, file.size() - 71, 4,
                false); // nine rationals are 72 bytes
    EXPECT_EQ(
        error_of(file).rfind("hostile.dng: ColorMatrix1 (50721) has 9 values of type"
                             " 10 that the file does not hold",
                             0),
        0U)
        << error_of(file);
}

/// SubIFDs and Exif that lead to a directory already read; entry value at @p tag.
std::string file_with_pointer_to_ifd0(Ifd ifd, int tag)
{
    ifd.longs(tag, { 0x11223344 });
    std::string file = file_of(ifd);
    const std::size_t at = file.find("\x44\x33\x22\x11");
    put(file, at, get(file, 4, 4, false), 4, false);
    return file;
}

TEST(HostileDng, CyclesAreNamed)
{
    for (const auto& [tag, name] :
         { std::pair(330, "SubIFD"), std::pair(34665, "ExifIFD") }) {
        Ifd ifd = tiny_dng();
        if (tag == 330)
            ifd.shorts(262, { 2 });
        const std::string message = error_of(file_with_pointer_to_ifd0(ifd, tag));
        EXPECT_EQ(message.rfind(std::string("hostile.dng: ") + name + " at byte ", 0),
                  0U)
            << message;
        EXPECT_NE(message.find("is a directory that was read before"),
                  std::string::npos);
    }
}

/// The next directory is IFD0 itself: the chain is not followed, so the file is whole.
TEST(HostileDng, ACyclicChainDoesNoHarm)
{
    std::string file = file_of(tiny_dng());
    put(file, file.size() - 4, get(file, 4, 4, false), 4, false);
    EXPECT_TRUE(survives(file));
}

/// 32 SubIFDs of 65535 entries each, which overlap in a file hardly longer than one.
TEST(HostileDng, OverlappingDirectoriesOf65535Entries)
{
    Ifd ifd = camera_tags();
    std::vector<std::uint64_t> offsets;
    for (std::uint64_t i = 0; i < 32; ++i)
        offsets.push_back(4096 + 2 * i);
    std::string file = file_of(ifd.shorts(262, { 2 }).longs(330, offsets));
    ASSERT_LT(file.size(), 4096U);
    file.resize(4096, '\0');
    file.append(64 + 2 + 65535 * 12, '\xFF');
    EXPECT_FALSE(survives(file));
}

/// A list of 4 MB would take a minute if each of 36 sites looked up each map at each
/// point. X-Trans has nine times the sites of Bayer.
TEST(HostileDng, SitesShareTheLookUpOfAMap)
{
    Ifd x_trans = tiny_dng();
    std::vector<std::uint64_t> colors;
    for (char letter : std::string("GGRGGBGGBGGRBRGRBGGGBGGRGGRGGBRBGBRG"))
        colors.push_back(std::string("RGB").find(letter));
    x_trans.shorts(33421, { 6, 6 }).bytes(33422, colors);
    OpcodeBuilder fine { 120, 120 }, coarse { 2, 2 };
    std::vector<TestOpcode> maps(64, coarse.gain_map());
    maps[0] = fine.gain_map();
    EXPECT_TRUE(survives(file_of(tiny_dng().bytes(51009, opcode_list(maps)))));
    const std::string file = file_of(x_trans.bytes(51009, opcode_list(maps)));
    EXPECT_TRUE(survives(file));
    std::istringstream stream(file);
    const DngMetadata metadata = read_dng_stream(stream, "maps.dng");
    ASSERT_EQ(metadata.gain_maps.size(), 64U);
    ASSERT_EQ(metadata.gain_maps[0].sites.size(), 36U);
    std::size_t looked_up = 0;
    const SiteGains gains
        = site_gains(metadata, { 0.5, 0.5 }, [&](const GainMapAt&, Place) {
              ++looked_up;
              return 2.0;
          });
    EXPECT_EQ(looked_up, 64U);
    EXPECT_EQ(gains[0], std::pow(2.0, 64));
}

} // namespace
} // namespace cg2raw::test

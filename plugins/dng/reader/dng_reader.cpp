// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Which directories of a DNG say what; the order in which they are asked.
#include "platform/paths.h"
#include "reader/layout.h"
#include "reader/metadata_parts.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace cg2raw {
namespace {

/// Real DNGs have up to ten; more would be a way to make us read for long.
constexpr Bounds sub_ifd_count { 1, 32 };
constexpr Bounds any_number { 0, 0xFFFFFFFF };
/// The newest DNG version whose rules this reader knows.
constexpr int newest_major = 1, newest_minor = 7;

/// The directories of one file, each read once: a second way to the same one is a
/// cycle.
class Directories {
public:
    explicit Directories(const TiffReader& file)
        : m_file(file)
    {
    }

    TiffIfd read(std::uint64_t offset, const std::string& what)
    {
        if (std::find(m_seen.begin(), m_seen.end(), offset) != m_seen.end())
            throw Error(
                m_file.name() + ": " + what + " at byte " + std::to_string(offset)
                + " is a directory that was read before; each must be another: the"
                  " file is cyclic or damaged");
        m_seen.push_back(offset);
        return m_file.ifd(offset, what);
    }

private:
    const TiffReader& m_file;
    std::vector<std::uint64_t> m_seen;
};

void check_version(const TiffTags& ifd0)
{
    if (!ifd0.has(tag::dng_version))
        ifd0.fail(
            tag::dng_version,
            "is missing: the file is no DNG; convert the camera's RAW to DNG first");
    if (!ifd0.has(tag::dng_backward_version))
        return;
    const auto version = ifd0.bytes(tag::dng_backward_version, { 4, 4 });
    if (version[0] > newest_major
        || (version[0] == newest_major && version[1] > newest_minor))
        ifd0.fail(tag::dng_backward_version,
                  "is " + std::to_string(version[0]) + "." + std::to_string(version[1])
                      + "; versions up to 1.7 are read: convert the file to DNG 1.7 or "
                        "older");
}

/// Full-resolution images say 0 for NewSubfileType, or nothing.
int photometric_of_main_image(const TiffTags& ifd)
{
    if (ifd.integer_or(tag::new_subfile_type, any_number, 0) != 0)
        return 0;
    return int(ifd.integer_or(tag::photometric, { 0, 65535 }, 0));
}

/// What an image is to a sensor: a mosaic is what it measured, which LinearRaw of the
/// one sample of a monochrome camera is too; of more samples it is demosaicked.
enum class Kind { mosaic, linear, other };

Kind kind_of(const TiffTags& image)
{
    const int photometric = photometric_of_main_image(image);
    if (photometric == photometric::linear_raw)
        return is_linear(image) ? Kind::linear : Kind::mosaic;
    return photometric == photometric::cfa ? Kind::mosaic : Kind::other;
}

/// Throws Error: of a file that has @p seen, but nothing of the kind that is wanted.
[[noreturn]] void fail_without(const TiffTags& main, Kind wanted, Kind seen)
{
    const std::string cfa = "CFA (" + std::to_string(photometric::cfa) + ")";
    if (seen == Kind::mosaic)
        main.fail(tag::photometric,
                  "is that of a mosaic, which says its own CFA: leave the CFA out, it"
                  " is for demosaicked files");
    if (seen == Kind::linear && wanted == Kind::mosaic)
        main.fail(tag::photometric,
                  "is LinearRaw (" + std::to_string(photometric::linear_raw)
                      + "), demosaicked as ProRAW is, and does not reveal the sensor's"
                        " CFA: use a DNG that keeps the mosaic, "
                      + cfa
                      + ", or make a profile by cg2raw profile --cfa RGGB (or"
                        " whichever it is)");
    main.fail(tag::photometric,
              "is " + cfa
                  + " in no full-resolution image; a mosaic is required: use a DNG"
                    " straight from the camera");
}

/// The directory of the image of that kind: IFD0 or one of its SubIFDs.
TiffIfd raw_ifd(const TiffReader& file, const TiffIfd& ifd0, Directories& directories,
                Kind wanted)
{
    const TiffTags main(file, { &ifd0 });
    Kind seen = kind_of(main);
    if (seen == wanted)
        return ifd0;
    std::vector<std::int64_t> offsets;
    if (main.has(tag::sub_ifds))
        offsets = main.integers(tag::sub_ifds, sub_ifd_count, any_offset);
    for (std::int64_t offset : offsets) {
        TiffIfd ifd = directories.read(std::uint64_t(offset), "SubIFD");
        const Kind kind = kind_of({ file, { &ifd } });
        if (kind == wanted)
            return ifd;
        seen = std::min(seen, kind);
    }
    fail_without(main, wanted, seen);
}

/// Empty if there is none.
TiffIfd exif_ifd(const TiffTags& main, Directories& directories)
{
    if (!main.has(tag::exif_ifd))
        return {};
    return directories.read(
        std::uint64_t(main.integers(tag::exif_ifd, { 1, 1 }, any_offset)[0]),
        "ExifIFD");
}

/// What a demosaicked file does not tell of its sensor.
void note_linear(const TiffTags& raw, DngMetadata& metadata)
{
    metadata.notes.push_back(
        text_of(tag::photometric) + " is LinearRaw: the CFA " + name_of(metadata.cfa)
        + " is as given; black and white level are those of the demosaicked image, and"
          " the sensor's own may differ");
    if (!metadata.noise_profile.empty())
        metadata.notes.push_back(
            text_of(tag::noise_profile)
            + " is of a demosaicked image, which may be a mean of several exposures,"
              " denoised: a mosaic is noisier; cg2raw calibrate measures it");
    if (raw.has(tag::opcode_list_2))
        metadata.notes.push_back(text_of(tag::opcode_list_2)
                                 + " is of a demosaicked image and not read: no lens"
                                   " shading is simulated");
}

} // namespace

bool is_linear(const TiffTags& image)
{
    return image.integer_or(tag::photometric, { 0, 65535 }, 0)
        == photometric::linear_raw
        && image.integer_or(tag::samples_per_pixel, { 1, 65535 }, 1) != 1;
}

DngMetadata read_dng_stream(std::istream& dng, const std::string& name,
                            const std::optional<CfaPattern>& cfa_of_linear,
                            DngLayout* layout)
{
    if (cfa_of_linear && cfa_of_linear->is_mono())
        throw Error(name
                    + ": cfa MONO has no colours to demosaick: give the CFA of the"
                      " sensor, such as RGGB");
    const TiffReader file(dng, name);
    Directories directories(file);
    const TiffIfd ifd0 = directories.read(file.first_ifd(), "IFD0");
    const TiffTags main(file, { &ifd0 });
    check_version(main);
    const TiffIfd raw
        = raw_ifd(file, ifd0, directories, cfa_of_linear ? Kind::linear : Kind::mosaic);
    const TiffIfd exif = exif_ifd(main, directories);

    DngMetadata metadata {};
    metadata.file = name;
    const TiffTags camera(file, { &ifd0, &raw });
    read_dng_levels({ file, { &raw } }, cfa_of_linear, metadata);
    if (layout)
        *layout = read_dng_layout(file, { file, { &raw } }, main);
    if (layout && !metadata.cfa.is_mono() && !camera.has(tag::color_matrix_1))
        metadata.notes.push_back(text_of(tag::color_matrix_1)
                                 + " is missing: the mosaic has no colours");
    else
        read_dng_color(camera, metadata);
    read_dng_noise({ file, { &raw, &ifd0 } }, metadata);
    if (cfa_of_linear) {
        undo_analog_balance(camera, metadata);
        note_linear({ file, { &raw } }, metadata);
    } else {
        read_dng_opcodes({ file, { &raw } }, metadata);
    }
    read_dng_names(camera, { file, { &exif, &ifd0 } }, metadata);
    if (!metadata.noise_profile.empty() && !metadata.shot.iso)
        metadata.notes.push_back(text_of(tag::iso_speed_ratings)
                                 + " is missing: the ISO of"
                                   " NoiseProfile is unknown");
    return metadata;
}

DngMetadata read_dng_metadata(const std::string& path,
                              const std::optional<CfaPattern>& cfa_of_linear)
{
    std::error_code unknown;
    if (!std::filesystem::is_regular_file(path_of(path), unknown))
        throw Error(path
                    + ": is no file; the reference must be a DNG of the target camera");
    std::ifstream dng(path_of(path), std::ios::binary);
    if (!dng)
        throw Error(path + ": cannot be opened for reading: check its permissions");
    return read_dng_stream(dng, path, cfa_of_linear);
}

} // namespace cg2raw

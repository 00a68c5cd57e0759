// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "writer/tags.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace cg2raw {

namespace {

/// Of the first and the second calibration.
constexpr TiffTag calibration_illuminants[]
    = { tag::calibration_illuminant_1, tag::calibration_illuminant_2 };
constexpr TiffTag color_matrices[] = { tag::color_matrix_1, tag::color_matrix_2 };
constexpr TiffTag forward_matrices[] = { tag::forward_matrix_1, tag::forward_matrix_2 };

using Shorts = std::vector<std::uint16_t>;
using Longs = std::vector<std::uint32_t>;
using Rationals = std::vector<Rational>;
using SignedRationals = std::vector<SignedRational>;

/// Matrices of real cameras have four decimals, and Adobe's renderer rounds to them.
constexpr std::int32_t camera_denominator = 10000;
/// The exact matrix keeps what it is: no reader tried minds, Adobe's renderer rounds.
constexpr std::int32_t exact_denominator = 10000000;
/// A coarser neutral costs temperature: 1/128 up to 82 K.
constexpr std::uint32_t neutral_denominator = 1000000;
/// Black levels are means; raw converters drop what is finer.
constexpr std::uint32_t black_denominator = 10000;
constexpr std::uint32_t aspect_denominator = 10000;
/// Demosaicing near the border lacks neighbours: renderers crop there, as cameras ask.
constexpr int crop_border = 2;
constexpr int smallest_cropped = 16;

SignedRationals matrix_value(const Mat3& matrix, std::int32_t denominator)
{
    SignedRationals value;
    for (const double m : matrix.m)
        value.push_back(signed_rational(m, denominator));
    return value;
}

/// The warmer calibration first: dcraw and LibRaw read all into one place, the last
/// stays, and they mean it to be the daylight one.
std::vector<Calibration> warm_first(std::vector<Calibration> calibrations)
{
    if (calibrations.size() == 2
        && light_source_temperature(calibrations[0].light_source).value
            > light_source_temperature(calibrations[1].light_source).value)
        std::swap(calibrations[0], calibrations[1]);
    return calibrations;
}

void add_text(Tags& tags, TiffTag tag, const std::string& text)
{
    if (!text.empty())
        tags.push_back({ tag, text });
}

void add_calibrations(Tags& tags, const DngDescription& description, Matrices matrices)
{
    const std::int32_t denominator
        = matrices == Matrices::exact ? exact_denominator : camera_denominator;
    std::size_t i = 0;
    for (const Calibration& calibration : warm_first(description.calibrations)) {
        tags.push_back({ calibration_illuminants[i],
                         Shorts { std::uint16_t(calibration.light_source) } });
        tags.push_back({ color_matrices[i],
                         matrix_value(calibration.camera_from_xyz, denominator) });
        if (calibration.xyz_d50_from_camera)
            tags.push_back(
                { forward_matrices[i],
                  matrix_value(*calibration.xyz_d50_from_camera, denominator) });
        ++i;
    }
}

Rationals black_value(const std::vector<double>& levels)
{
    const bool whole = std::all_of(levels.begin(), levels.end(),
                                   [](double dn) { return dn == std::floor(dn); });
    Rationals value;
    for (const double dn : levels)
        value.push_back(rational(dn, whole ? 1 : black_denominator));
    return value;
}

/// Factors, horizontal first, that make pixels square; no pixel is given up.
Rationals default_scale(double pixel_aspect)
{
    Rational longer
        = rational(std::max(pixel_aspect, 1.0 / pixel_aspect), aspect_denominator);
    const std::uint32_t common = std::gcd(longer.numerator, longer.denominator);
    longer = { longer.numerator / common, longer.denominator / common };
    const Rational one { 1, 1 };
    return pixel_aspect < 1.0 ? Rationals { one, longer } : Rationals { longer, one };
}

void add_crop(Tags& tags, Size size, Crop crop, double pixel_aspect)
{
    const bool whole
        = crop == Crop::none || std::min(size.width, size.height) < smallest_cropped;
    const std::uint32_t border = whole ? 0 : crop_border;
    const std::uint32_t width = std::uint32_t(size.width);
    const std::uint32_t height = std::uint32_t(size.height);
    tags.push_back({ tag::active_area, Longs { 0, 0, height, width } });
    tags.push_back({ tag::default_scale, default_scale(pixel_aspect) });
    tags.push_back(
        { tag::default_crop_origin, Rationals { { border, 1 }, { border, 1 } } });
    tags.push_back(
        { tag::default_crop_size,
          Rationals { { width - 2 * border, 1 }, { height - 2 * border, 1 } } });
}

void add_cfa(Tags& tags, const CfaPattern& cfa)
{
    const Shorts repeat { std::uint16_t(cfa.height), std::uint16_t(cfa.width) };
    tags.push_back({ tag::cfa_repeat_pattern_dim, repeat });
    tags.push_back({ tag::cfa_pattern,
                     Bytes(cfa.colors.begin(), cfa.colors.begin() + cfa.sites()) });
    tags.push_back({ tag::cfa_plane_color, Bytes { 0, 1, 2 } });
    tags.push_back({ tag::cfa_layout, Shorts { 1 } }); // rectangular
    tags.push_back({ tag::black_level_repeat_dim, repeat });
}

} // namespace

Tags shot_tags(const Shot& shot)
{
    Tags tags;
    if (shot.time_code) {
        const auto bytes = smpte_331m(*shot.time_code, shot.frame_rate);
        tags.push_back({ tag::time_codes, Bytes(bytes.begin(), bytes.end()) });
    }
    if (shot.frame_rate)
        tags.push_back({ tag::frame_rate,
                         SignedRationals { { shot.frame_rate->numerator,
                                             shot.frame_rate->denominator } } });
    add_text(tags, tag::reel_name, shot.reel_name);
    add_text(tags, tag::camera_label, shot.camera_label);
    return tags;
}

Tags camera_tags(const DngDescription& description, const DngOptions& options)
{
    Tags tags {
        { tag::dng_version, Bytes { 1, 4, 0, 0 } },
        { tag::dng_backward_version, Bytes { 1, 3, 0, 0 } }, // opcodes came with 1.3
        { tag::orientation, Shorts { std::uint16_t(description.shot.orientation) } },
        { tag::software, std::string("cg2raw " CG2RAW_VERSION) },
    };
    add_text(tags, tag::make, description.make);
    add_text(tags, tag::model, description.model);
    add_text(tags, tag::unique_camera_model, description.unique_camera_model);
    add_text(tags, tag::image_description, description.shot.description);
    add_text(tags, tag::artist, description.shot.artist);
    add_text(tags, tag::copyright, description.shot.copyright);
    add_text(tags, tag::date_time, description.shot.date_time_original);
    const std::string xmp = xmp_packet(description);
    tags.push_back({ tag::xmp, Bytes(xmp.begin(), xmp.end()) });
    add_calibrations(tags, description, options.matrices);
    // Green stays 1 though red may pass 1 under tungsten: Adobe's renderer divides by
    // the maximum itself, LibRaw, dcraw, RawTherapee and RawSpeed take reciprocals.
    Rationals neutral;
    for (const double channel : description.as_shot_neutral)
        neutral.push_back(rational(channel, neutral_denominator));
    if (!description.cfa.is_mono())
        tags.push_back({ tag::as_shot_neutral, neutral });
    if (options.tone_curve == ToneCurve::linear) {
        tags.push_back({ tag::profile_tone_curve, std::vector<float> { 0, 0, 1, 1 } });
        tags.push_back({ tag::default_black_render, Longs { 1 } }); // 1 = none
    }
    return tags;
}

Tags mosaic_tags(const DngDescription& description, const DngOptions& options)
{
    Tags tags { { tag::new_subfile_type, Longs { 0 } } };
    if (!description.cfa.is_mono())
        add_cfa(tags, description.cfa);
    tags.push_back({ tag::black_level, black_value(description.black_level) });
    tags.push_back(
        { tag::white_level, Longs { std::uint32_t(description.white_level) } });
    add_crop(tags, description.size, options.crop,
             description.shot.pixel_aspect.value_or(1.0));
    if (!description.noise_profile.empty()) {
        std::vector<double> pairs;
        for (const NoisePair& pair : description.noise_profile)
            pairs.insert(pairs.end(), { pair.scale, pair.offset });
        tags.push_back({ tag::noise_profile, pairs });
    }
    if (description.shading_gains)
        tags.push_back(
            { tag::opcode_list_2,
              Undefined { gain_map_opcodes(*description.shading_gains, description.cfa,
                                           description.size) } });
    return tags;
}

Tags preview_tags()
{
    return { { tag::new_subfile_type, Longs { 1 } }, // a reduced image
             { tag::preview_color_space, Longs { 2 } } }; // sRGB
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Matrices, neutral and noise, with the one camera's calibration folded in:
/// camera_from_xyz = AB CC CM and
/// xyz_d50_from_camera = FM D inverse(AB CC), D = 1 / (inverse(AB CC) neutral).
/// Source: DNG specification 1.7.1, chapter 6.
#include "reader/metadata_parts.h"

#include "cg2raw/illuminant.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace cg2raw {
namespace {

/// What a matrix that names no light is taken to hold for. Adobe's published matrices
/// of one light, which other software copies into its files, are those of D65.
constexpr int assumed_light_source = 21;
/// Entries and gains beyond these are damage; real ones stay within 0.1 to 10.
constexpr double smallest_gain = 0.001, largest_entry = 1000.0;
/// The profile's own bounds of R/G and B/G.
constexpr double darkest_neutral = 0.01, brightest_neutral = 100.0;

constexpr Mat3 identity { { 1, 0, 0, 0, 1, 0, 0, 0, 1 } };

/// The tags of one calibration.
struct CalibrationTags {
    TiffTag light_source, color_matrix, camera_calibration, forward_matrix;
};
constexpr CalibrationTags first_tags { tag::calibration_illuminant_1,
                                       tag::color_matrix_1, tag::camera_calibration_1,
                                       tag::forward_matrix_1 };
constexpr CalibrationTags second_tags { tag::calibration_illuminant_2,
                                        tag::color_matrix_2, tag::camera_calibration_2,
                                        tag::forward_matrix_2 };

/// @p matrix, of @p tag, if it has an inverse and no entry beyond the bound.
Mat3 checked(const TiffTags& camera, TiffTag tag, const Mat3& matrix)
{
    for (double value : matrix.m)
        if (!(std::abs(value) <= largest_entry))
            camera.fail(tag,
                        "has an entry beyond +-1000: the file is damaged, use another"
                        " DNG of this camera");
    try {
        inverse(matrix);
    } catch (const Error&) {
        camera.fail(tag,
                    "is singular; it must have an inverse: the file is damaged, use"
                    " another DNG of this camera");
    }
    return matrix;
}

Mat3 read_matrix(const TiffTags& camera, TiffTag tag)
{
    const auto values = camera.numbers(tag, { 9, 9 });
    Mat3 result {};
    std::copy(values.begin(), values.end(), result.m.begin());
    return checked(camera, tag, result);
}

Mat3 read_analog_balance(const TiffTags& camera)
{
    if (!camera.has(tag::analog_balance))
        return identity;
    const auto gains = camera.numbers(tag::analog_balance, { 3, 3 });
    for (double gain : gains)
        if (!(gain >= smallest_gain && gain <= largest_entry))
            camera.fail(tag::analog_balance,
                        "has a gain outside 0.001 to 1000: the file is damaged");
    return diagonal({ gains[0], gains[1], gains[2] });
}

/// CameraCalibration belongs to the matrices only if both carry the same signature;
/// none on either side is the same.
bool calibration_applies(const TiffTags& camera)
{
    return camera.text(tag::camera_calibration_signature)
        == camera.text(tag::profile_calibration_signature);
}

std::optional<double> temperature_of(int light_source)
{
    try {
        return light_source_temperature(light_source).value;
    } catch (const Error&) {
        return std::nullopt;
    }
}

Vec3 reciprocal(const Vec3& v) { return { 1.0 / v[0], 1.0 / v[1], 1.0 / v[2] }; }

/// A ForwardMatrix that takes the individual camera's balanced colours. It stays as it
/// is when @p camera_from_reference is diagonal; otherwise it depends on the neutral,
/// and the neutral of the calibration's own light stands for all.
Mat3 folded_forward(const Mat3& forward, const Mat3& camera_from_reference,
                    const Calibration& calibration)
{
    const Mat3& scale = camera_from_reference;
    if (scale(0, 1) == 0 && scale(0, 2) == 0 && scale(1, 0) == 0 && scale(1, 2) == 0
        && scale(2, 0) == 0 && scale(2, 1) == 0)
        return forward;
    const Chromaticity light
        = planckian_xy(light_source_temperature(calibration.light_source));
    const Vec3 neutral = calibration.camera_from_xyz * xyz_from_xy(light);
    const Mat3 reference_from_camera = inverse(scale);
    const Vec3 reference_gains = reciprocal(reference_from_camera * neutral);
    return forward * diagonal(reference_gains) * reference_from_camera
        * diagonal(neutral);
}

int read_light_source(const TiffTags& camera, TiffTag tag, DngMetadata& metadata)
{
    const int light_source = int(camera.integer_or(tag, { 0, 65535 }, 0));
    if (temperature_of(light_source))
        return light_source;
    metadata.notes.push_back(
        std::string(tag.name) + " (" + std::to_string(tag.number) + ") "
        + (camera.has(tag) ? "has no known temperature" : "is missing")
        + ": its matrix is taken to be the one for D65");
    return assumed_light_source;
}

/// AnalogBalance times CameraCalibration: from the model's reference camera to this
/// one.
Mat3 read_camera_from_reference(const TiffTags& camera, TiffTag camera_calibration,
                                DngMetadata& metadata)
{
    const Mat3 balance = read_analog_balance(camera);
    if (!camera.has(camera_calibration))
        return balance;
    if (calibration_applies(camera))
        return checked(camera, camera_calibration,
                       balance * read_matrix(camera, camera_calibration));
    metadata.notes.push_back(std::string(camera_calibration.name) + " does not apply: "
                             + text_of(tag::camera_calibration_signature)
                             + " differs from "
                             + text_of(tag::profile_calibration_signature));
    return balance;
}

/// ForwardMatrix. If white misses D50 by more than rounding, its rows are scaled to the
/// sums that take it there, as renderers do with those of all files; nothing if it
/// cannot be.
std::optional<Mat3> read_forward(const TiffTags& camera, TiffTag tag,
                                 DngMetadata& metadata)
{
    const Mat3 forward = read_matrix(camera, tag);
    const double denominator = camera.largest_denominator(tag);
    if (maps_white_to_d50(forward, denominator))
        return forward;
    const Vec3 white = forward * Vec3 { 1, 1, 1 }, d50 = xyz_from_xy(d50_white);
    const bool has_scale = std::min({ white[0], white[1], white[2] }) > 0.0;
    metadata.notes.push_back(
        text_of(tag) + " " + white_text(forward, denominator)
        + (has_scale ? ": its rows are scaled to it" : ": it is not used"));
    if (!has_scale)
        return std::nullopt;
    return diagonal({ d50[0] / white[0], d50[1] / white[1], d50[2] / white[2] })
        * forward;
}

Calibration read_calibration(const TiffTags& camera, const CalibrationTags& tags,
                             DngMetadata& metadata)
{
    Calibration result {};
    result.light_source = read_light_source(camera, tags.light_source, metadata);
    const Mat3 camera_from_reference
        = read_camera_from_reference(camera, tags.camera_calibration, metadata);
    result.camera_from_xyz
        = checked(camera, tags.color_matrix,
                  camera_from_reference * read_matrix(camera, tags.color_matrix));
    const Vec3 white = result.camera_from_xyz * xyz_from_xy(d50_white);
    if (!(std::min({ white[0], white[1], white[2] }) > 0.0))
        camera.fail(
            tags.color_matrix,
            "maps white to a channel of 0 or below; each channel must see white:"
            " use another DNG of this camera");
    if (!camera.has(tags.forward_matrix))
        return result;
    if (const auto forward = read_forward(camera, tags.forward_matrix, metadata))
        result.xyz_d50_from_camera
            = checked(camera, tags.forward_matrix,
                      folded_forward(*forward, camera_from_reference, result));
    return result;
}

/// Two matrices are worth something only between two different temperatures; raw
/// converters use the first alone otherwise, and so does this.
bool second_is_usable(const TiffTags& camera)
{
    const auto kelvin = [&](TiffTag tag) {
        return temperature_of(int(camera.integer_or(tag, { 0, 65535 }, 0)));
    };
    const auto first = kelvin(tag::calibration_illuminant_1);
    const auto second = kelvin(tag::calibration_illuminant_2);
    return first && second && *first != *second;
}

void read_calibrations(const TiffTags& camera, DngMetadata& metadata)
{
    metadata.calibrations.push_back(read_calibration(camera, first_tags, metadata));
    if (!camera.has(tag::color_matrix_2))
        metadata.notes.push_back(text_of(tag::color_matrix_2)
                                 + " is missing: one matrix serves all"
                                   " lights, and its colours are those of its own");
    else if (second_is_usable(camera))
        metadata.calibrations.push_back(
            read_calibration(camera, second_tags, metadata));
    else
        metadata.notes.push_back(
            "CalibrationIlluminant1 and 2 ("
            + std::to_string(tag::calibration_illuminant_1.number) + ", "
            + std::to_string(tag::calibration_illuminant_2.number)
            + ") are not two"
              " lights of known, different temperature: ColorMatrix1"
              " serves all lights, as in raw converters");
    if (camera.has(tag::color_matrix_3))
        metadata.notes.push_back(text_of(tag::color_matrix_3)
                                 + " is not used: two lights are"
                                   " interpolated, not three");
}

/// @p neutral over its green, if it is one.
Vec3 checked_neutral(const TiffTags& camera, TiffTag tag, const Vec3& neutral)
{
    const Vec3 over_green { neutral[0] / neutral[1], 1.0, neutral[2] / neutral[1] };
    bool legal = neutral[1] > 0.0;
    for (double ratio : over_green)
        legal = legal && ratio >= darkest_neutral && ratio <= brightest_neutral;
    if (!legal) {
        std::ostringstream what;
        what << "gives the neutral " << neutral[0] << " " << neutral[1] << " "
             << neutral[2]
             << "; R/G and B/G must be 0.01 to 100: use another DNG of this camera";
        camera.fail(tag, what.str());
    }
    return over_green;
}

Vec3 neutral_from_xy(const TiffTags& camera, const DngMetadata& metadata)
{
    const auto xy = camera.numbers(tag::as_shot_white_xy, { 2, 2 });
    if (!(xy[0] > 0.0 && xy[1] > 0.0 && xy[0] + xy[1] < 1.0))
        camera.fail(tag::as_shot_white_xy,
                    "is no chromaticity; x and y must be above 0 and"
                    " x + y below 1: the file is damaged");
    SensorProfile profile {};
    profile.calibrations = metadata.calibrations;
    const Chromaticity white { xy[0], xy[1] };
    return camera_from_xyz(profile, white) * xyz_from_xy(white);
}

} // namespace

void read_dng_color(const TiffTags& camera, DngMetadata& metadata)
{
    if (metadata.cfa.is_mono()) {
        if (camera.has(tag::color_matrix_1))
            metadata.notes.push_back(text_of(tag::color_matrix_1)
                                     + " is not used: the sensor is monochrome");
        return;
    }
    read_calibrations(camera, metadata);
    if (camera.has(tag::as_shot_neutral)) {
        const auto neutral = camera.numbers(tag::as_shot_neutral, { 3, 3 });
        metadata.as_shot_neutral = checked_neutral(
            camera, tag::as_shot_neutral, { neutral[0], neutral[1], neutral[2] });
    } else if (camera.has(tag::as_shot_white_xy)) {
        metadata.as_shot_neutral = checked_neutral(camera, tag::as_shot_white_xy,
                                                   neutral_from_xy(camera, metadata));
    } else {
        metadata.notes.push_back(text_of(tag::as_shot_neutral) + " and "
                                 + text_of(tag::as_shot_white_xy)
                                 + " are missing: the file names no illuminant");
    }
}

void undo_analog_balance(const TiffTags& camera, DngMetadata& metadata)
{
    if (!camera.has(tag::analog_balance))
        return;
    const Mat3 balance = read_analog_balance(camera);
    const Mat3 sensor_from_file = inverse(balance);
    for (Calibration& calibration : metadata.calibrations)
        calibration.camera_from_xyz = sensor_from_file * calibration.camera_from_xyz;
    if (metadata.as_shot_neutral)
        metadata.as_shot_neutral = checked_neutral(
            camera, tag::as_shot_neutral, sensor_from_file * *metadata.as_shot_neutral);
    metadata.notes.push_back(text_of(tag::analog_balance)
                             + " is taken back: it is how the demosaicked image was"
                               " balanced, and not the sensor's");
}

void read_dng_noise(const TiffTags& raw, DngMetadata& metadata)
{
    if (!raw.has(tag::noise_profile))
        return;
    const bool mono = metadata.cfa.is_mono();
    const auto values = raw.numbers(tag::noise_profile, { 2, mono ? 2 : 8 });
    if (values.size() == 8) {
        metadata.notes.push_back(text_of(tag::noise_profile)
                                 + " has 4 planes where the"
                                   " specification has 1 or, of this sensor, 3, and"
                                   " does not say which is which: the noise is taken"
                                   " to be unknown");
        return;
    }
    if (values.size() != 2 && values.size() != 6)
        raw.fail(tag::noise_profile,
                 "has " + std::to_string(values.size())
                     + " values; allowed: 2 (all planes) or 6 (a pair per plane)");
    for (double value : values)
        if (!(value >= 0.0 && value <= 1.0))
            raw.fail(tag::noise_profile,
                     "has a value outside 0 to 1, for a signal of 0 to"
                     " 1: the file is damaged");
    for (std::size_t plane = 0; plane < (mono ? 1 : 3); ++plane) {
        const std::size_t at = values.size() == 2 ? 0 : 2 * plane;
        metadata.noise_profile.push_back({ values[at], values[at + 1] });
    }
    const bool silent = std::all_of(values.begin(), values.end(),
                                    [](double value) { return value == 0.0; });
    if (silent) {
        metadata.noise_profile.clear();
        metadata.notes.push_back(text_of(tag::noise_profile)
                                 + " holds zeros only: the noise is taken"
                                   " to be unknown");
    }
}

} // namespace cg2raw

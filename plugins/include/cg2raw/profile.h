// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file 1 - SensorProfile: all that is known of one sensor, and where it is read from.
#pragma once

#include "cg2raw/color.h"
#include "cg2raw/spectrum.h"
#include "cg2raw/types.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace cg2raw {

/// Colours of a CFA's repeat, row major, 0 = R, 1 = G, 2 = B; phase of the top-left
/// active pixel. 2x2 for Bayer, 6x6 for X-Trans; 1x1 for a sensor without filters,
/// whose signal is the luminance of the scene: it stands in all three planes of its
/// camera RGB, and the mosaic takes green's.
struct CfaPattern {
    int width = 2, height = 2;
    std::array<std::uint8_t, 36> colors {};

    int color(Site at) const
    {
        return colors[std::size_t(at.row % height * width + at.col % width)];
    }
    int sites() const { return width * height; }
    bool is_mono() const { return sites() == 1; }
};

/// "rggb", "grbg", "gbrg" or "bggr", or the letters of a 4x4 or 6x6 repeat, row major,
/// each of R, G and B present, or "mono" for a sensor without filters; in either case.
/// Throws Error on other words; X-Trans is none, since its phase differs between
/// bodies.
CfaPattern cfa_from_name(std::string_view name);
/// The same word in upper case: "RGGB", "MONO".
std::string name_of(const CfaPattern& cfa);
/// That of a sensor without filters.
CfaPattern mono_cfa();

/// What the maker measured under one light.
struct Calibration {
    int light_source; ///< EXIF LightSource: 17 = A, 21 = D65 ...
    Mat3 camera_from_xyz; ///< DNG ColorMatrix
    std::optional<Mat3> xyz_d50_from_camera; ///< DNG ForwardMatrix (balanced camera)
};

/// EXIF LightSource of a light that it has no name for.
constexpr int other_light_source = 255;

/// What was measured under a lamp whose spectrum no temperature describes, such as a
/// fluorescent one.
struct Lamp {
    std::string name; ///< FL2: letters, digits, '.', '_' and '-'
    std::array<double, 2> neutral; ///< R/G, B/G of grey
    Calibration calibration; ///< its light source may be other_light_source
    std::optional<Spectrum> power {}; ///< relative; none: not known
};

/// The lamp of this name, which may follow "lamp:"; upper and lower case, and '.', '_'
/// and '-', are alike. nullptr: none of @p lamps.
const Lamp* lamp_named(const std::vector<Lamp>& lamps, std::string_view word);

/// Of matrices whose values a file has as fractions: the least that cameras have.
/// Source: DNGs of Android phones.
constexpr double coarsest_denominator = 128.0;

/// Whether a ForwardMatrix takes balanced white, (1, 1, 1), to the XYZ of D50, as the
/// DNG specification, chapter 6, has it; up to the rounding of values over
/// @p denominator. Where only decimals are known, as in a profile, they may be those of
/// the coarsest.
bool maps_white_to_d50(const Mat3& xyz_d50_from_camera,
                       double denominator = coarsest_denominator);

/// Of one that does not: "maps white to XYZ ...; it must be that of D50, ...".
std::string white_text(const Mat3& xyz_d50_from_camera,
                       double denominator = coarsest_denominator);

/// Temperature that raw converters give an EXIF LightSource code (A = 2850, D50 = 5000,
/// D65 = 6500 K). Throws Error for a code without one.
Kelvin light_source_temperature(int light_source);
/// EXIF LightSource of "A", "D50", "D55", "D65", "D75" ... Throws Error on other words.
int light_source_from_name(std::string_view name);
std::string light_source_name(int light_source);
/// Those that light_source_from_name() takes.
std::vector<std::string> light_source_names();

/// One of the Gaussians that a sensor's neutrals are a mixture of.
struct NeutralGaussian {
    double weight = 0.0; ///< share of the neutrals
    std::array<double, 2> mean {}; ///< R/G, B/G
    std::array<double, 3> covariance {}; ///< rr, rb, bb
};

/// Where the sensor's neutrals lie: chromaticities (R/G, B/G) of grey under real
/// lights.
struct NeutralDistribution {
    std::vector<std::array<double, 2>> neutrals; ///< as measured; may be empty
    std::array<double, 2> mean {};
    std::array<double, 3> covariance {}; ///< rr, rb, bb; divisor N - 1
    std::vector<std::array<double, 2>>
        hull; ///< convex, counter-clockwise, up to 1000 corners; empty: none known
    /// Closer to the neutrals than their one Gaussian, where they are not listed; up to
    /// 16, weights of sum 1; empty: none known.
    std::vector<NeutralGaussian> mixture;
};

/// Mean, covariance and convex hull of @p neutrals.
NeutralDistribution distribution_of(std::vector<std::array<double, 2>> neutrals);

/// Bounds of a Tukey lambda: with much heavier tails than at -0.4 there is no variance,
/// and at 0.5 no tail.
constexpr double least_tukey_lambda = -0.4, most_tukey_lambda = 0.5;

/// Draws of the read-out noise that are wider than the others.
struct Outliers {
    double fraction; ///< of the draws, 0 to 0.5
    double variance_ratio; ///< their variance over that of the others, 1 to 100
};
constexpr double most_outliers = 0.5, most_outlier_variance_ratio = 100.0;

/// How the noise at one ISO is distributed, beyond its variance. Source: K. Wei et al.,
/// Physics-based Noise Modeling for Extreme Low-light Photography, IEEE Trans. PAMI
/// 44(11), 2022.
struct NoiseShape {
    double tukey_lambda; ///< of the read-out noise without that of rows
    double row_sigma; ///< standard deviation of a row's offset, in 0..1 above black
    std::optional<Outliers> outliers {}; ///< all rows of a profile have them, or none
};

/// Heteroscedastic noise at one ISO, one value per CFA site:
/// variance(x) = beta1 x + beta2 with x in 0..1 above black. beta1 is the signal of one
/// electron. beta2 is all that does not depend on the signal: with a shape,
/// beta2 - row_sigma^2 is the read-out noise of the pixels themselves, outliers
/// included.
struct NoiseAtIso {
    double iso;
    std::vector<double> beta1, beta2;
    std::optional<NoiseShape> shape {}; ///< all rows of a profile have one, or none
};

/// The effects that draw the noise of an ISO.
struct NoiseEffects {
    std::string of_light = "shot_noise"; ///< or poisson_shot_noise
    std::string of_readout = "read_noise"; ///< or heavy_tailed_noise: needs shapes
};
/// Of the two names in this order. Throws Error that says what is allowed.
NoiseEffects noise_effects_from_names(const std::vector<std::string>& names);

/// An effect as a profile lists it.
struct EffectSetting {
    std::string name;
    std::map<std::string, double> parameters;
    std::string evidence; ///< JSON text, kept as it came
};

struct DigitalGain {
    double mean, sigma;
};

/// (field, where it is from) each.
using TextsByField = std::vector<std::pair<std::string, std::string>>;

/// Its members are the fields of its JSON: profile_fields.def says what each is.
struct SensorProfile {
#define CG2RAW_FIELD(type, name, rule, meaning) type name {};
#include "cg2raw/profile_fields.def"
#undef CG2RAW_FIELD
};

/// Files are named by ids, and a file's name has 255 bytes at most.
constexpr std::size_t longest_sensor_id = 100;
/// What is wrong with @p id, quoted; empty if a sensor can have it: up to
/// longest_sensor_id lower-case letters, digits, '-' and '.', a letter or digit first.
std::string sensor_id_fault(std::string_view id);

/// Read a profile (JSON, schema 1). @p file names the source in messages.
/// Throws Error naming file, field, value and what is allowed; unknown fields are
/// errors, as are fields given twice and texts larger than a profile can be: 16 MiB,
/// 250000 values, 1000 fields of one object, 32 objects and lists in each other.
SensorProfile parse_profile(std::string_view json, const std::string& file);
/// The profile as JSON that parse_profile reads back, field for field, unless it is
/// larger than that reads. Throws Error for text that is not UTF-8.
std::string to_json(const SensorProfile& profile);

/// A profile by id (folders of profile_folders()) or by path (has a slash or ends in
/// .json). Throws Error; for an unknown id the message lists those installed, and a
/// word that is no file's name (dots alone, control characters, 300 letters) is sought
/// nowhere.
SensorProfile load_profile(const std::string& id_or_path);
/// Throws Error if an invariant of the profile does not hold; @p file leads the
/// message.
void check(const SensorProfile& profile, const std::string& file);

/// Folders searched, in order: $CG2RAW_PROFILE_PATH, then share/cg2raw/profiles of the
/// installation that this code runs from.
std::vector<std::string> profile_folders();
/// Ids of all profiles found there, sorted.
std::vector<std::string> installed_profiles();

/// Noise at any ISO: log-log interpolation between calibrated ISOs, and up to one stop
/// beyond them; tukey_lambda and outliers are linear in log ISO and constant beyond the
/// ends, and row_sigma^2 at most beta2. Throws Error farther out, or if the profile has
/// no noise.
NoiseAtIso noise_at(const SensorProfile& profile, double iso);

} // namespace cg2raw

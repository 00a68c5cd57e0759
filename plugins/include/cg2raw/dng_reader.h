// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Metadata of a real DNG, and the sensor profile that it amounts to.
#pragma once

#include "cg2raw/dng_description.h"

namespace cg2raw {

/// A GainMap of a real file: what its raw converter multiplies the mosaic by, at some
/// sites of the CFA, to undo the shading of the lens.
struct GainMapAt {
    std::vector<int> sites; ///< of the CFA's repeat, row major, rising
    int top, left, bottom, right; ///< pixels of the active area, the last two excluded
    int row_pitch, col_pitch; ///< every so many rows and columns from top, left
    /// Of the map's points, in heights and widths of the active area.
    double spacing_v, spacing_h, origin_v, origin_h;
    GainMap map; ///< each gain above 0
};

/// The black level of each pixel of the active area, DN after linearisation: a pattern
/// that repeats from the area's corner, and what BlackLevelDeltaH and V add to it.
struct BlackByPixel {
    int rows, cols; ///< of the pattern
    std::vector<double> pattern; ///< row major; empty of a demosaicked image
    std::vector<double> by_col, by_row; ///< one per column and row; empty: nothing
    double largest; ///< of all pixels

    double at(Site pixel) const;
};

/// What one DNG says of its camera and its shot, resolved from whichever IFD holds it.
struct DngMetadata {
    std::string file;
    /// Trimmed UTF-8; model or unique_camera_model may be empty, not both.
    std::string make, model, unique_camera_model;
    Size active_area;
    /// 2x2 to 6x6, or that of a monochrome sensor; phase of the active area's corner.
    CfaPattern cfa;
    /// That white_level needs, 8 to 16; the file's samples are often wider.
    int bits;
    /// DN per CFA site: means of BlackLevel and its deltas.
    std::vector<double> black_level;
    BlackByPixel black;
    /// DN after linearisation, as black_level.
    int white_level;
    /// One or two in the file's order, AnalogBalance and CameraCalibration folded in;
    /// every light source has a temperature. None of a monochrome sensor.
    std::vector<Calibration> calibrations;
    std::optional<Vec3> as_shot_neutral; ///< G = 1
    /// Per colour plane R, G, B, or of the one; empty: none.
    std::vector<NoisePair> noise_profile;
    /// Stops by which a converter is to brighten the file.
    std::optional<double> baseline_exposure;
    /// Those of OpcodeList2, which raw converters apply before they demosaic.
    std::vector<GainMapAt> gain_maps;
    Shot shot;
    /// What was missing or had to be simplified, and what stands in for it; one
    /// sentence each.
    std::vector<std::string> notes;
};

/// Reads metadata only, a few kilobytes of a file of any size. Tags that are not needed
/// are not looked at. Throws Error naming file, tag, value and bound for whatever is
/// missing, malformed, cyclic or larger than the file can hold.
///
/// A file whose image is demosaicked, LinearRaw of three samples as ProRAW is, does not
/// say its sensor's CFA: @p cfa_of_linear does, of such files alone, and its phase is
/// that of the active area's corner. Levels and noise are those of the planes then, and
/// opcodes are not read; notes say so.
/// Source: DNG specification 1.7.1; TIFF 6.0.
DngMetadata read_dng_metadata(const std::string& path,
                              const std::optional<CfaPattern>& cfa_of_linear
                              = std::nullopt);

/// A profile as one reference DNG defines it: id from the model, one neutral, noise at
/// the file's ISO where NoiseProfile says it, lens_shading and color_shading where
/// GainMaps do; notes are among its sources. Throws Error if the file has no neutral
/// and is not monochrome, or if what it says is no profile that check() lets pass.
SensorProfile profile_from_dng(const DngMetadata& metadata);

/// The profile of a reference DNG with what only a measured profile knows: illuminants,
/// digital gain, effects, and noise if it has any. Throws Error, which calls the DNG
/// @p file, if the two are not of one camera, or do not fit as those of another CFA.
SensorProfile with_measurements(SensorProfile reference, const SensorProfile& measured,
                                const std::string& file);

/// Exif of a reference DNG, and of the image what that lacks. Orientation, author,
/// rights and description are the image's own: they are not the camera's. So are frame
/// rate, time code, reel and camera label: the reference is a frame of another shot.
Shot merged(Shot reference, const Shot& image);

/// A profile, and what its files lack or had simplified with what that costs: one
/// sentence each, none twice. The profile's sources hold the notes too.
struct ProfileOfDngs {
    SensorProfile profile;
    std::vector<std::string> notes;
};

/// A profile as several DNGs of one camera define it: all their neutrals, a row of
/// noise per ISO (means where several files have it), the mean shading of their
/// GainMaps.
/// @p id: as sensor_id_fault() asks; empty: from the model.
/// Throws Error for no files, for files of several cameras, sizes, CFAs, white levels
/// or matrices, naming the files, and for black levels that differ by more than 1 DN
/// and 0.2 % of the white level.
ProfileOfDngs profile_from_dngs(const std::vector<DngMetadata>& files,
                                const std::string& id = "");

/// A camera's name as an id: lower case, words joined by '-'. "GoPro HERO6 Black" ->
/// "gopro-hero6-black"; cut to longest_sensor_id. Empty if the name has no ASCII letter
/// or digit.
std::string sensor_id_from_name(std::string_view name);
/// What people call a camera: the first word of its make, then its model, which may
/// begin with that word already, in either case.
std::string camera_name(const std::string& make, const std::string& model);

} // namespace cg2raw

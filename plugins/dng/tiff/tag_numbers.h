// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The tags that the reader looks at and the writer writes: the one place of
/// their numbers.
#pragma once

#include <cstdint>
#include <string>

namespace cg2raw {

/// A tag's number and the name that messages give it.
struct TiffTag {
    std::uint16_t number;
    const char* name;
};

/// Numbers and names. Source: TIFF 6.0, Exif 2.32, DNG specification 1.7.1,
/// CinemaDNG 1.1; of XMP, ISO 16684-1. Those from
/// 50936 on are younger than libtiff 4.5's table.
namespace tag {
constexpr TiffTag new_subfile_type { 254, "NewSubfileType" };
constexpr TiffTag image_width { 256, "ImageWidth" };
constexpr TiffTag image_length { 257, "ImageLength" };
constexpr TiffTag bits_per_sample { 258, "BitsPerSample" };
constexpr TiffTag compression { 259, "Compression" };
constexpr TiffTag photometric { 262, "PhotometricInterpretation" };
constexpr TiffTag fill_order { 266, "FillOrder" };
constexpr TiffTag image_description { 270, "ImageDescription" };
constexpr TiffTag make { 271, "Make" };
constexpr TiffTag model { 272, "Model" };
constexpr TiffTag strip_offsets { 273, "StripOffsets" };
constexpr TiffTag orientation { 274, "Orientation" };
constexpr TiffTag samples_per_pixel { 277, "SamplesPerPixel" };
constexpr TiffTag rows_per_strip { 278, "RowsPerStrip" };
constexpr TiffTag strip_byte_counts { 279, "StripByteCounts" };
constexpr TiffTag software { 305, "Software" };
constexpr TiffTag date_time { 306, "DateTime" };
constexpr TiffTag artist { 315, "Artist" };
constexpr TiffTag predictor { 317, "Predictor" };
constexpr TiffTag tile_width { 322, "TileWidth" };
constexpr TiffTag tile_length { 323, "TileLength" };
constexpr TiffTag tile_offsets { 324, "TileOffsets" };
constexpr TiffTag tile_byte_counts { 325, "TileByteCounts" };
constexpr TiffTag sub_ifds { 330, "SubIFDs" };
constexpr TiffTag sample_format { 339, "SampleFormat" };
constexpr TiffTag xmp { 700, "XMP" };
constexpr TiffTag cfa_repeat_pattern_dim { 33421, "CFARepeatPatternDim" };
constexpr TiffTag cfa_pattern { 33422, "CFAPattern" };
constexpr TiffTag copyright { 33432, "Copyright" };
constexpr TiffTag exposure_time { 33434, "ExposureTime" };
constexpr TiffTag f_number { 33437, "FNumber" };
constexpr TiffTag exif_ifd { 34665, "ExifIFD" };
/// PhotographicSensitivity since Exif 2.3.
constexpr TiffTag iso_speed_ratings { 34855, "ISOSpeedRatings" };
constexpr TiffTag sensitivity_type { 34864, "SensitivityType" };
constexpr TiffTag recommended_exposure_index { 34866, "RecommendedExposureIndex" };
constexpr TiffTag iso_speed { 34867, "ISOSpeed" };
constexpr TiffTag exif_version { 36864, "ExifVersion" };
constexpr TiffTag date_time_original { 36867, "DateTimeOriginal" };
constexpr TiffTag brightness_value { 37379, "BrightnessValue" };
constexpr TiffTag exposure_bias_value { 37380, "ExposureBiasValue" };
constexpr TiffTag focal_length { 37386, "FocalLength" };
constexpr TiffTag exposure_mode { 41986, "ExposureMode" };
constexpr TiffTag lens_model { 42036, "LensModel" };
constexpr TiffTag dng_version { 50706, "DNGVersion" };
constexpr TiffTag dng_backward_version { 50707, "DNGBackwardVersion" };
constexpr TiffTag unique_camera_model { 50708, "UniqueCameraModel" };
constexpr TiffTag cfa_plane_color { 50710, "CFAPlaneColor" };
constexpr TiffTag cfa_layout { 50711, "CFALayout" };
constexpr TiffTag linearization_table { 50712, "LinearizationTable" };
constexpr TiffTag black_level_repeat_dim { 50713, "BlackLevelRepeatDim" };
constexpr TiffTag black_level { 50714, "BlackLevel" };
constexpr TiffTag black_level_delta_h { 50715, "BlackLevelDeltaH" };
constexpr TiffTag black_level_delta_v { 50716, "BlackLevelDeltaV" };
constexpr TiffTag white_level { 50717, "WhiteLevel" };
constexpr TiffTag default_scale { 50718, "DefaultScale" };
constexpr TiffTag default_crop_origin { 50719, "DefaultCropOrigin" };
constexpr TiffTag default_crop_size { 50720, "DefaultCropSize" };
constexpr TiffTag color_matrix_1 { 50721, "ColorMatrix1" };
constexpr TiffTag color_matrix_2 { 50722, "ColorMatrix2" };
constexpr TiffTag camera_calibration_1 { 50723, "CameraCalibration1" };
constexpr TiffTag camera_calibration_2 { 50724, "CameraCalibration2" };
constexpr TiffTag analog_balance { 50727, "AnalogBalance" };
constexpr TiffTag as_shot_neutral { 50728, "AsShotNeutral" };
constexpr TiffTag as_shot_white_xy { 50729, "AsShotWhiteXY" };
constexpr TiffTag baseline_exposure { 50730, "BaselineExposure" };
constexpr TiffTag calibration_illuminant_1 { 50778, "CalibrationIlluminant1" };
constexpr TiffTag calibration_illuminant_2 { 50779, "CalibrationIlluminant2" };
constexpr TiffTag active_area { 50829, "ActiveArea" };
constexpr TiffTag camera_calibration_signature { 50931, "CameraCalibrationSignature" };
constexpr TiffTag profile_calibration_signature { 50932,
                                                  "ProfileCalibrationSignature" };
constexpr TiffTag profile_tone_curve { 50940, "ProfileToneCurve" };
constexpr TiffTag forward_matrix_1 { 50964, "ForwardMatrix1" };
constexpr TiffTag forward_matrix_2 { 50965, "ForwardMatrix2" };
constexpr TiffTag preview_color_space { 50970, "PreviewColorSpace" };
constexpr TiffTag sub_tile_block_size { 50974, "SubTileBlockSize" };
constexpr TiffTag row_interleave_factor { 50975, "RowInterleaveFactor" };
constexpr TiffTag opcode_list_1 { 51008, "OpcodeList1" };
constexpr TiffTag opcode_list_2 { 51009, "OpcodeList2" };
constexpr TiffTag opcode_list_3 { 51022, "OpcodeList3" };
constexpr TiffTag noise_profile { 51041, "NoiseProfile" };
constexpr TiffTag time_codes { 51043, "TimeCodes" };
constexpr TiffTag frame_rate { 51044, "FrameRate" };
constexpr TiffTag reel_name { 51081, "ReelName" };
constexpr TiffTag camera_label { 51105, "CameraLabel" };
constexpr TiffTag default_black_render { 51110, "DefaultBlackRender" };
constexpr TiffTag color_matrix_3 { 52531, "ColorMatrix3" };
} // namespace tag

/// Name and number, as messages say them: "Make (271)".
inline std::string text_of(TiffTag tag)
{
    return std::string(tag.name) + " (" + std::to_string(tag.number) + ")";
}

/// Values of PhotometricInterpretation.
namespace photometric {
constexpr std::uint16_t rgb = 2, cfa = 32803, linear_raw = 34892;
} // namespace photometric

} // namespace cg2raw

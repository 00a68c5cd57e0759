// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The parts that read_dng_metadata() is made of; private to it.
#pragma once

#include "cg2raw/dng_reader.h"

#include "tiff/reader.h"

namespace cg2raw {

struct DngLayout;

/// read_dng_metadata() of any stream that can seek; @p name names it in messages. Into
/// @p layout, unless it is null, goes where the mosaic lies; one without a ColorMatrix
/// is a mosaic, too.
DngMetadata read_dng_stream(std::istream& dng, const std::string& name,
                            const std::optional<CfaPattern>& cfa_of_linear
                            = std::nullopt,
                            DngLayout* layout = nullptr);

/// Whether an image is LinearRaw of several samples: demosaicked.
bool is_linear(const TiffTags& image);
/// active_area, cfa, black_level, white_level, bits of the raw IFD; of a demosaicked
/// one, for the sites of @p cfa_of_linear.
void read_dng_levels(const TiffTags& raw,
                     const std::optional<CfaPattern>& cfa_of_linear,
                     DngMetadata& metadata);
/// calibrations and as_shot_neutral; @p camera looks into IFD0, then the raw IFD.
void read_dng_color(const TiffTags& camera, DngMetadata& metadata);
/// Takes back from these what the converter of a demosaicked file multiplied it by.
void undo_analog_balance(const TiffTags& camera, DngMetadata& metadata);
/// noise_profile; @p raw looks into the raw IFD, then IFD0.
void read_dng_noise(const TiffTags& raw, DngMetadata& metadata);
/// gain_maps, and notes of all other opcodes; needs active_area and cfa.
void read_dng_opcodes(const TiffTags& raw, DngMetadata& metadata);
/// DefaultScale, horizontal first; nothing if it is missing or makes no sense.
std::optional<std::array<double, 2>> read_default_scale(const TiffTags& image);
/// make, model, unique_camera_model and shot; @p exif looks into the Exif IFD, then
/// IFD0.
void read_dng_names(const TiffTags& camera, const TiffTags& exif,
                    DngMetadata& metadata);

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What a DNG's IFDs say of the pixels: description -> tags. Pixel storage is not
/// here. Tag numbers and types: DNG specification 1.4, chapters 4 and 5; Exif 2.3.
#pragma once

#include "cg2raw/dng_writer.h"
#include "tiff/tag_values.h"

namespace cg2raw {

/// Make, model, colour and texts: IFD 0, whatever its pixels are.
Tags camera_tags(const DngDescription& description, const DngOptions& options);
/// The frame's place in a shot, also IFD 0. Source: CinemaDNG 1.1, 4.
Tags shot_tags(const Shot& shot);
/// CFA, levels, crop, noise, shading: the IFD of the mosaic.
Tags mosaic_tags(const DngDescription& description, const DngOptions& options);
/// What makes IFD 0 a preview.
Tags preview_tags();
/// The Exif IFD; only fields that are known.
Tags exif_tags(const Shot& shot);

/// The XMP packet: that the picture is computer generated, and how.
std::string xmp_packet(const DngDescription& description);

/// OpcodeList2 with the gain maps of the colours R, G, B. Throws Error if a map's size
/// is not rows x cols.
Bytes gain_map_opcodes(const std::array<GainMap, 3>& maps, const CfaPattern& cfa,
                       Size size);

/// Throws Error, which @p path leads, for a description that no DNG can express.
void check(const DngDescription& description, const std::string& path);

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The rules of an export, by what they decide; private to resolve().
#pragma once

#include "cg2raw/export.h"

namespace cg2raw {

/// What every rule reads.
struct Given {
    const ImageFacts& facts;
    const ExportOptions& options;
    const Dialect& dialect;

    /// An option as its user types it, with a value or without.
    std::string option(std::string_view name, std::string_view value = {}) const
    {
        return dialect.option(name, value);
    }
};

/// Throws Error for a deep image, or a volume.
void require_flat(const ImagePart& part);

/// The name of the colour space that @p part states; empty if it states none.
std::string color_space(const Given& given, const ImagePart& part);

/// The curve that encodes the numbers of @p part, and thereby the decoder. Throws
/// Error, with the remedy, for pixels that are neither RAW nor scene-linear Rec.709
/// then.
void decide_encoding(const Given& given, const ImagePart& part, Export& result);

/// The Exif that renderers and oiiotool put into an image; its FramesPerSecond,
/// smpte:TimeCode, reelName and cameraLabel, unless options say others. Throws Error
/// for a time code without a rate, and for one whose first frame is not said.
Shot shot(const Given& given, const ImagePart& part, std::int64_t frame);

/// The frame number that the time code of an image is.
std::optional<std::int64_t> time_code_frame(const Metadata& metadata);

/// Makes pixels the light that the sensor's channels see, and white what its
/// sensitivities make of the light that is named; "estimate" is the one that the file
/// states. Throws Error for what has no meaning for spectra, and for a sensor without
/// sensitivities.
void decide_spectrum(const Given& given, const ImagePart& part, Export& result);

/// Throws Error for options that only spectra are good for.
void refuse_spectral_options(const Given& given, const std::string& illuminant);

} // namespace cg2raw

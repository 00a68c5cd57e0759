// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What a host of OpenImageIO says of an image, as resolve() takes it.
#pragma once

#include "cg2raw/export.h"

#include <OpenImageIO/imageio.h>

namespace cg2raw {

/// The facts of an image that becomes the file @p name. Throws Error for channels that
/// its pixels do not have.
ImageFacts image_facts(const OIIO::ImageSpec& spec, const std::string& name);

/// The dng:* attributes. Throws Error for an unknown one, and for values that are not
/// allowed.
ExportOptions attribute_options(const OIIO::ImageSpec& spec);

/// Options as attributes of oiiotool.
const Dialect& attribute_dialect();

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Dates of Exif, for what reads them and what takes them from an image.
#pragma once

#include <string>

namespace cg2raw {

/// Whether a text is a date as Exif writes it, "YYYY:MM:DD HH:MM:SS".
bool is_exif_date(const std::string& text);

} // namespace cg2raw

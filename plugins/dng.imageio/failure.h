// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What a host hears of an exception: a message that names the file. None leaves
/// the plugin, which would end the host.
#pragma once

#include <OpenImageIO/imageio.h>

#include <functional>
#include <string>

namespace cg2raw {

/// Calls @p tell with one line for the exception that is being handled, of file @p name
/// with pixels as @p spec has them; the file leads it unless it is named already. If
/// there is no memory for a message, nobody is told.
void tell_failure(const std::string& name, const OIIO::ImageSpec& spec,
                  const std::function<void(const std::string&)>& tell) noexcept;

} // namespace cg2raw

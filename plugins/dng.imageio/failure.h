// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What a host hears of an exception: a message that names the file. None leaves
/// the plugin, which would end the host.
#pragma once

#include "messages.h"

#include <OpenImageIO/imageio.h>

#include <new>

namespace cg2raw {

/// Calls tell(message) for the exception that is being handled, of file @p name with
/// pixels as @p spec has them. If there is no memory for a message, nobody is told.
template <class Tell>
void tell_failure(const std::string& name, const OIIO::ImageSpec& spec,
                  const Tell& tell) noexcept
try {
    try {
        throw;
    } catch (const std::bad_alloc&) {
        const std::string size = std::to_string(spec.width) + " x "
            + std::to_string(spec.height) + " pixels";
        tell(led_by_name(name,
                         "not enough memory" + (spec.width > 0 ? " for " + size : "")));
    } catch (const std::exception& error) {
        tell(led_by_name(name, error.what()));
    } catch (...) {
        tell(led_by_name(name, "unknown failure"));
    }
} catch (...) {
    return; // there is no memory for a message
}

} // namespace cg2raw

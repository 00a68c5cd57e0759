// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "failure.h"

#include "cg2raw/types.h"

#include <new>

namespace cg2raw {
namespace {

std::string led_by_name(const std::string& file, const std::string& message)
{
    const std::string name = Error(file).what(); // as messages have it
    const bool names_file = message.find(name) != message.npos;
    return Error(names_file ? message : file + ": " + message).what();
}

} // namespace

void tell_failure(const std::string& name, const OIIO::ImageSpec& spec,
                  const std::function<void(const std::string&)>& tell) noexcept
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

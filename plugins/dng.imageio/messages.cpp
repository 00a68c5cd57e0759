// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "messages.h"

#include "cg2raw/types.h"

namespace cg2raw {

std::string led_by_name(const std::string& file, const std::string& message)
{
    const std::string name = Error(file).what(); // as messages have it
    const bool names_file = message.find(name) != message.npos;
    return Error(names_file ? message : file + ": " + message).what();
}

} // namespace cg2raw

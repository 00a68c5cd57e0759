// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "exif_date.h"

namespace cg2raw {

bool is_exif_date(const std::string& text)
{
    const std::string form = "dddd:dd:dd dd:dd:dd";
    if (text.size() != form.size())
        return false;
    for (std::size_t i = 0; i < form.size(); ++i)
        if (form[i] == 'd' ? text[i] < '0' || text[i] > '9' : text[i] != form[i])
            return false;
    return true;
}

} // namespace cg2raw

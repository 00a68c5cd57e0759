// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "cg2raw/dng_writer.h"

namespace cg2raw {

namespace {

/// The value that @p word names. Throws Error that lists the words.
template <class Value, std::size_t count>
Value named(const char* option, std::string_view word,
            const std::pair<const char*, Value> (&values)[count])
{
    std::string allowed;
    for (const auto& [name, value] : values) {
        if (word == name)
            return value;
        allowed += std::string(allowed.empty() ? "" : " or ") + name;
    }
    throw Error(std::string(option) + " is \"" + std::string(word) + "\", but must be "
                + allowed);
}

} // namespace

Compression compression_from_name(std::string_view name)
{
    return named<Compression>("compression", name,
                              { { "none", Compression::none },
                                { "ljpeg", Compression::ljpeg },
                                { "ljpeg-2d", Compression::ljpeg_2d } });
}

Matrices matrices_from_name(std::string_view name)
{
    return named<Matrices>(
        "matrices", name,
        { { "camera", Matrices::camera }, { "exact", Matrices::exact } });
}

Crop crop_from_name(std::string_view name)
{
    return named<Crop>("crop", name,
                       { { "border", Crop::border }, { "none", Crop::none } });
}

ToneCurve tone_curve_from_name(std::string_view name)
{
    return named<ToneCurve>(
        "tone_curve", name,
        { { "camera", ToneCurve::camera }, { "linear", ToneCurve::linear } });
}

Shading shading_from_name(std::string_view name)
{
    return named<Shading>(
        "shading", name,
        { { "tagged", Shading::tagged }, { "baked", Shading::baked } });
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "profile_json_spectral.h"

namespace cg2raw {
namespace {

std::vector<std::string> channels_of(const CfaPattern& cfa)
{
    return cfa.is_mono() ? std::vector<std::string> { "mono" }
                         : std::vector<std::string> { "R", "G", "B" };
}

} // namespace

SpectralSensitivities sensitivities_from_json(Fields fields, const CfaPattern& cfa)
{
    SpectralSensitivities result;
    result.wavelengths = fields.reals("wavelengths", 0);
    const std::size_t count = result.wavelengths.size();
    result.rgb.resize(count);
    const std::vector<std::string> channels = channels_of(cfa);
    for (std::size_t channel : { 0, 1, 2 }) {
        const std::string& name = channels[channel % channels.size()];
        const std::vector<double> values = fields.reals(name, 0);
        if (values.size() != count)
            fields.fail(name,
                        "has " + std::to_string(values.size())
                            + " values; it needs one per wavelength, "
                            + std::to_string(count));
        for (std::size_t i = 0; i < count; ++i)
            result.rgb[i][channel] = values[i];
    }
    const std::string unit = fields.has("unit") ? fields.text("unit") : "energy";
    try {
        result.unit = spectral_unit_from_name(unit);
    } catch (const Error& error) {
        fields.fail("unit", error.what());
    }
    if (fields.has("scale"))
        result.scale = fields.real("scale");
    fields.done();
    return result;
}

JsonTree json_of(const SpectralSensitivities& sensitivities, const CfaPattern& cfa)
{
    JsonTree json = JsonTree::object()
                        .with("unit", name_of(sensitivities.unit))
                        .with("scale", sensitivities.scale)
                        .with("wavelengths", sensitivities.wavelengths);
    const std::vector<std::string> channels = channels_of(cfa);
    for (std::size_t channel = 0; channel < channels.size(); ++channel) {
        std::vector<double> values;
        for (const Vec3& rgb : sensitivities.rgb)
            values.push_back(rgb[channel]);
        json.set(channels[channel], values);
    }
    return json;
}

} // namespace cg2raw

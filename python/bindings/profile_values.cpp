// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "profile_values.h"

namespace cg2raw::python {
namespace {

py::array_t<double> square_of(const std::array<double, 3>& covariance)
{
    const auto& [rr, rb, bb] = covariance;
    const std::array<double, 4> rows { rr, rb, rb, bb };
    return py::array_t<double>({ 2, 2 }, rows.data());
}

} // namespace

py::dict to_python(const NoiseAtIso& noise)
{
    py::dict dict("iso"_a = noise.iso, "beta1"_a = noise.beta1,
                  "beta2"_a = noise.beta2);
    if (noise.shape) {
        dict["tukey_lambda"] = noise.shape->tukey_lambda;
        dict["row_sigma"] = noise.shape->row_sigma;
    }
    if (noise.shape && noise.shape->outliers) {
        dict["outlier_fraction"] = noise.shape->outliers->fraction;
        dict["outlier_variance_ratio"] = noise.shape->outliers->variance_ratio;
    }
    return dict;
}

py::dict to_python(const Calibration& calibration)
{
    const auto& forward = calibration.xyz_d50_from_camera;
    return py::dict("light_source"_a = light_source_name(calibration.light_source),
                    "camera_from_xyz"_a = array_of(calibration.camera_from_xyz),
                    "xyz_d50_from_camera"_a
                    = forward ? py::object(array_of(*forward)) : py::none());
}

py::dict to_python(const SpectralSensitivities& sensitivities)
{
    const auto& rgb = sensitivities.rgb;
    py::array_t<double> values({ py::ssize_t(rgb.size()), py::ssize_t(3) });
    auto to = values.mutable_unchecked<2>();
    for (std::size_t i = 0; i < rgb.size(); ++i)
        for (std::size_t channel : { 0, 1, 2 })
            to(py::ssize_t(i), py::ssize_t(channel)) = rgb[i][channel];
    return py::dict("wavelengths"_a = py::array_t<double>(
                        py::ssize_t(rgb.size()), sensitivities.wavelengths.data()),
                    "rgb"_a = values, "unit"_a = name_of(sensitivities.unit),
                    "scale"_a = sensitivities.scale);
}

py::dict to_python(const NeutralDistribution& lights)
{
    py::list mixture;
    for (const NeutralGaussian& gaussian : lights.mixture)
        mixture.append(py::dict("weight"_a = gaussian.weight, "mean"_a = gaussian.mean,
                                "covariance"_a = square_of(gaussian.covariance)));
    return py::dict("neutrals"_a = lights.neutrals, "mean"_a = lights.mean,
                    "covariance"_a = square_of(lights.covariance),
                    "hull"_a = lights.hull, "mixture"_a = mixture);
}

py::dict to_python(const Lamp& lamp)
{
    const auto& [light_source, camera_from_xyz, forward] = lamp.calibration;
    return py::dict("name"_a = lamp.name,
                    "light_source"_a = light_source_name(light_source),
                    "neutral"_a = lamp.neutral, "has_power"_a = bool(lamp.power),
                    "camera_from_xyz"_a = array_of(camera_from_xyz));
}

py::dict to_python(const DigitalGain& gain)
{
    return py::dict("mean"_a = gain.mean, "sigma"_a = gain.sigma);
}

std::vector<std::string> to_python(const std::optional<NoiseEffects>& effects)
{
    const auto [of_light, of_readout] = effects.value_or(NoiseEffects {});
    return { of_light, of_readout };
}

py::dict to_python(const EffectSetting& setting)
{
    return py::dict("name"_a = setting.name, "parameters"_a = setting.parameters,
                    "evidence"_a = setting.evidence);
}

py::dict dict_of(const Effect& effect, const std::vector<Parameter>& of_cfa)
{
    py::list parameters;
    for (const Parameter& p : of_cfa)
        parameters.append(py::dict("name"_a = p.name, "unit"_a = p.unit,
                                   "min"_a = p.min, "max"_a = p.max, "null"_a = p.null,
                                   "optional"_a = p.optional, "meaning"_a = p.meaning));
    return py::dict("name"_a = effect.name, "stage"_a = name_of(effect.stage),
                    "pattern"_a = name_of(effect.pattern), "parameters"_a = parameters,
                    "needs_exposure_time"_a = effect.needs_exposure_time,
                    "reach"_a = effect.reach, "meaning"_a = effect.meaning,
                    "source"_a = effect.source);
}

} // namespace cg2raw::python

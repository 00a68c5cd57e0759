// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "bindings.h"
#include "constructor.h"
#include "profile_values.h"

#include "cg2raw/dng_reader.h"
#include "cg2raw/effect.h"

namespace cg2raw::python {
namespace {

/// Of all CFAs; or those that one has, with its parameters.
py::list effects_of(const std::optional<std::string>& cfa)
{
    py::list list;
    for (const Effect& effect : all_effects()) {
        if (!cfa) {
            list.append(dict_of(effect, effect.parameters));
            continue;
        }
        const CfaPattern pattern = cfa_from_name(*cfa);
        if (has_effect(pattern, effect))
            list.append(dict_of(effect, parameters_of(effect, pattern, "profile")));
    }
    return list;
}

/// All that a light is, by value.
py::tuple values_of(const Illuminant& i)
{
    return py::make_tuple(i.spec, i.sensor, i.neutral[0], i.neutral[1], i.neutral[2],
                          i.xy.x, i.xy.y, i.temperature.cct.value, i.temperature.duv);
}

/// A light is a value: it is compared, copied and pickled as such.
void bind_value(py::class_<Illuminant>& c)
{
    def_constructor(
        c,
        +[](const std::string& spec, const std::string& sensor, const Vec3& neutral,
            const std::array<double, 2>& xy, double cct, double duv) {
            return Illuminant {
                spec, sensor, neutral, { xy[0], xy[1] }, { { cct }, duv }
            };
        },
        "spec"_a, "sensor"_a, "neutral"_a, "xy"_a, "cct"_a, "duv"_a,
        "The light that has these values, as pickle keeps them; Sensor.illuminant "
        "names one.");
    c.def(
         "__eq__",
         [](const Illuminant& a, const Illuminant& b) {
             return values_of(a).equal(values_of(b));
         },
         py::is_operator())
        .def("__hash__", [](const Illuminant& i) { return py::hash(values_of(i)); })
        .def("__reduce__", [](const Illuminant& i) {
            return remade_as<Illuminant>(i.spec, i.sensor, i.neutral,
                                         std::array<double, 2> { i.xy.x, i.xy.y },
                                         i.temperature.cct.value, i.temperature.duv);
        });
}

void bind_illuminant(py::module_& m)
{
    py::class_<Illuminant> c(m, "Illuminant", "A light as one sensor sees it.");
    bind_value(c);
    c.def_readonly("spec", &Illuminant::spec, "The word that named it.")
        .def_readonly("sensor", &Illuminant::sensor,
                      "Id of the sensor that sees it so.")
        .def_readonly("neutral", &Illuminant::neutral,
                      "Camera RGB of a neutral patch (AsShotNeutral): (R, G = 1, B).")
        .def_property_readonly(
            "xy",
            [](const Illuminant& i) {
                return std::array<double, 2> { i.xy.x, i.xy.y };
            },
            "CIE 1931 chromaticity, as a raw converter derives it from the neutral.")
        .def_property_readonly(
            "cct", [](const Illuminant& i) { return i.temperature.cct.value; },
            "Correlated colour temperature of xy, K.")
        .def_property_readonly(
            "duv", [](const Illuminant& i) { return i.temperature.duv; },
            "Distance from the Planckian locus in CIE 1960 uv, positive above it.")
        .def("__repr__", [](const Illuminant& i) {
            return "<Illuminant " + i.spec + ": "
                + std::to_string(int(i.temperature.cct.value)) + " K>";
        });
    m.attr("illuminant_grammar") = illuminant_grammar;
    m.def("illuminant_list", &illuminant_list, "words"_a,
          "The single words of a list such as \"A,D65,sample:0-9\".\n\n"
          "Raises ValueError that lists the grammar.");
    m.def(
        "raw_space_from_name",
        [](const std::string& name)
            -> std::optional<std::pair<std::string, std::string>> {
            const auto space = raw_space_from_name(name, installed_profiles());
            if (!space)
                return std::nullopt;
            return std::pair(space->sensor, space->illuminant);
        },
        "name"_a,
        "(sensor, illuminant) of a colour space named \"RAW - <sensor> - "
        "<illuminant>\", or\n"
        "of its alias; None for the name of another space.");
    m.def(
        "raw_space_name",
        [](const std::string& sensor, const std::string& illuminant) {
            return raw_space_name({ sensor, illuminant });
        },
        "sensor"_a, "illuminant"_a, "Name of the colour space of a sensor's RAW.");
    m.def(
        "raw_space_alias",
        [](const std::string& sensor, const std::string& illuminant) {
            return raw_space_alias({ sensor, illuminant });
        },
        "sensor"_a, "illuminant"_a, "Its alias: lower case, with underscores.");
    m.def(
        "raw_space_interop_id",
        [](const std::string& sensor, const std::string& illuminant) {
            return raw_space_interop_id({ sensor, illuminant });
        },
        "sensor"_a, "illuminant"_a, "Its interop ID: the alias, in a namespace.");
}

void bind_search(py::module_& m)
{
    m.def("load_profile", &load_profile, "id_or_path"_a,
          "A sensor profile by id, or by path (has a slash or ends in .json).");
    m.def("parse_profile", &parse_profile, "json"_a, "file"_a = "profile",
          "A sensor profile from its JSON text; file names it in messages.");
    m.def("installed_profiles", &installed_profiles,
          "Ids of all profiles found, sorted.");
    m.def("profile_folders", &profile_folders, "Folders that are searched, in order.");
    m.def("profile_schema", &profile_schema,
          "The JSON Schema of a profile, with the effects of the registry.");
    m.def(
        "camera_name", &camera_name, "make"_a, "model"_a,
        "What people call a camera: the first word of its make, then its model, which "
        "may\nbegin with that word already.");
    m.def("sensor_id_from_name", &sensor_id_from_name, "name"_a,
          "A camera's name as an id: lower case, words joined by '-'.");
    m.def("current_effect_name", &current_effect_name, "name"_a,
          "What an effect of this name is called now; the name itself if it was never "
          "another.");
    m.def(
        "effects", &effects_of, "cfa"_a = py::none(),
        "Every effect that a profile may list: name, stage, parameters, meaning, "
        "source,\nneeds_exposure_time, reach in px.\n\n"
        "cfa : only what a profile of that CFA may list, with the parameters that it "
        "has there:\n    \"MONO\" has one site, and nothing that tells colours apart.");
}

void bind_numbers(py::class_<SensorProfile>& c)
{
    c.def("to_json", &to_json, "The profile as JSON text that reads back the same.")
        .def("__reduce__",
             [](const SensorProfile& p) {
                 return remade_as<SensorProfile>(to_json(p), p.id);
             })
        .def(
            "illuminant", &illuminant, "spec"_a, "as_shot"_a = py::none(),
            "The Illuminant that a word names; as_shot: what \"as-shot\" means.\n\n"
            "spec : A D50 D55 D65 D75, 3200K, xy:0.3457:0.3585, neutral:0.55:0.45 (R/G "
            "and B/G),\n    sample:7 (of the Gaussian of the sensor's neutrals), "
            "measured:7 (near them) or as-shot.\n"
            "Raises ValueError that lists the grammar.")
        .def(
            "spectrum",
            [](const SensorProfile& p, const Illuminant& light) {
                const auto [power, name] = spectrum_of(p, light);
                const auto array = [](const std::vector<double>& values) {
                    return py::array_t<double>(py::ssize_t(values.size()),
                                               values.data());
                };
                return py::dict("name"_a = name,
                                "wavelengths"_a = array(power.wavelengths),
                                "power"_a = array(power.values));
            },
            "illuminant"_a,
            "{\"name\", \"wavelengths\", \"power\"} of an Illuminant, as convention "
            "spectral takes it: (n,) nm\nand (n,), relative. That of a lamp or of a "
            "word "
            "of the CIE; of other neutrals the\nnearest of black bodies, daylight, "
            "lamps "
            "and mixtures of two. Raises ValueError for a\nprofile without "
            "spectral_sensitivities.")
        .def(
            "xy_from_neutral",
            [](const SensorProfile& p, const Vec3& neutral) {
                const NeutralChromaticity n = xy_from_neutral(p, neutral);
                return py::make_tuple(py::make_tuple(n.xy.x, n.xy.y), n.passes,
                                      n.converged);
            },
            "neutral"_a,
            "((x, y), passes, converged), as a raw converter iterates them.")
        .def(
            "camera_from_xyz",
            [](const SensorProfile& p, std::array<double, 2> xy) {
                return array_of(camera_from_xyz(p, { xy[0], xy[1] }));
            },
            "xy"_a, "(3, 3) float64 ColorMatrix interpolated at chromaticity xy.")
        .def(
            "warm_weight",
            [](const SensorProfile& p, std::array<double, 2> xy) {
                return warm_weight(p, { xy[0], xy[1] });
            },
            "xy"_a, "Weight of the warmer calibration at xy, 0 to 1.")
        .def(
            "paper_temperature",
            [](const SensorProfile& p, const Vec3& neutral) {
                const Temperature t = paper_temperature(p, neutral);
                return std::array<double, 2> { t.cct.value, t.duv };
            },
            "neutral"_a,
            "(K, Duv) as the paper's reference implementation iterates them.")
        .def(
            "noise_at",
            [](const SensorProfile& p, double iso) {
                return to_python(noise_at(p, iso));
            },
            "iso"_a,
            "{\"iso\", \"beta1\", \"beta2\"} per CFA site: variance(x) = beta1 x + "
            "beta2, x "
            "in 0..1\nabove black; and where the profile has them \"tukey_lambda\" and "
            "\"row_sigma\", or\nthese and \"outlier_fraction\" and "
            "\"outlier_variance_ratio\".\n\nInterpolated in log ISO, up to one stop "
            "beyond the "
            "calibrated ISOs; raises\nValueError farther out.");
}

/// The attributes of a profile are its fields; profile_fields lists them with their
/// types, of which scripts/generate.py makes the stub.
void bind_fields(py::module_& m, py::class_<SensorProfile>& c)
{
    py::list fields;
#define CG2RAW_FIELD(type, name, rule, meaning)                                        \
    c.def_property_readonly(                                                           \
        #name, [](const SensorProfile& p) { return to_python(p.name); },               \
        (std::string(meaning) + python_type<type>.parts).c_str());                     \
    fields.append(py::make_tuple(#name, python_type<type>.word));
#include "cg2raw/profile_fields.def"
#undef CG2RAW_FIELD
    m.attr("profile_fields") = py::tuple(fields);
    c.def_property_readonly(
        "neutrals", [](const SensorProfile& p) { return p.illuminants.neutrals; },
        "Measured neutrals, (R/G, B/G) each.");
}

} // namespace

void bind_profile(py::module_& m)
{
    bind_illuminant(m);
    py::class_<SensorProfile> c(m, "SensorProfile", "All that is known of one sensor.");
    def_constructor(
        c,
        +[](const std::string& json, const std::string& file) {
            return parse_profile(json, file);
        },
        "json"_a, "file"_a = "profile", "As parse_profile, for pickle.");
    bind_fields(m, c);
    bind_numbers(c);
    bind_search(m);
}

} // namespace cg2raw::python

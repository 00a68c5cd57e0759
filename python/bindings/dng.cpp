// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "bindings.h"

#include "cg2raw/dng_mosaic.h"
#include "cg2raw/dng_reader.h"
#include "cg2raw/dng_writer.h"

#include <algorithm>
#include <cmath>

namespace cg2raw::python {
namespace {

void write(const std::string& path, const RawArray& raw, const Simulation& simulation,
           const std::string& compression, std::optional<bool> preview,
           const std::string& matrices, const std::string& tone_curve, int threads,
           const Shot& shot, bool sync, bool drawn, const std::string& crop,
           const std::optional<std::string>& shading)
{
    DngOptions options { compression_from_name(compression), preview,
                         matrices_from_name(matrices),
                         tone_curve_from_name(tone_curve) };
    options.sync = sync;
    options.crop = crop_from_name(crop);
    if (shading)
        options.shading = shading_from_name(*shading);
    write_frame(path, raw, simulation, options, shot, threads, drawn);
}

DngMetadata read(const std::string& path, const std::string& cfa)
{
    if (cfa.empty())
        return read_dng_metadata(path);
    return read_dng_metadata(path, cfa_from_name(cfa));
}

template <class T> py::object optional_of(const std::optional<T>& value)
{
    return value ? py::cast(*value) : py::none();
}

py::dict dict_of(const Shot& shot)
{
    return py::dict("exposure_time"_a = optional_of(shot.exposure_time),
                    "f_number"_a = optional_of(shot.f_number),
                    "focal_length"_a = optional_of(shot.focal_length),
                    "iso"_a = optional_of(shot.iso),
                    "exposure_bias"_a = optional_of(shot.exposure_bias),
                    "exposure_mode"_a = shot.exposure_mode
                        ? py::object(py::int_(int(*shot.exposure_mode)))
                        : py::none(),
                    "brightness"_a = optional_of(shot.brightness),
                    "date_time_original"_a = shot.date_time_original,
                    "orientation"_a = shot.orientation,
                    "pixel_aspect"_a = optional_of(shot.pixel_aspect),
                    "frame_rate"_a = text_or_none(shot.frame_rate),
                    "time_code"_a = text_or_none(shot.time_code),
                    "reel_name"_a = shot.reel_name,
                    "camera_label"_a = shot.camera_label);
}

py::list list_of(const std::vector<Calibration>& calibrations)
{
    py::list list;
    for (const Calibration& c : calibrations)
        list.append(py::dict("light_source"_a = c.light_source,
                             "camera_from_xyz"_a = array_of(c.camera_from_xyz),
                             "xyz_d50_from_camera"_a = c.xyz_d50_from_camera
                                 ? py::object(array_of(*c.xyz_d50_from_camera))
                                 : py::none()));
    return list;
}

py::list list_of(const std::vector<GainMapAt>& maps)
{
    py::list list;
    for (const GainMapAt& at : maps) {
        FloatArray gains({ at.map.rows, at.map.cols });
        std::copy(at.map.gains.begin(), at.map.gains.end(), gains.mutable_data());
        list.append(py::dict(
            "sites"_a = at.sites,
            "area"_a = py::make_tuple(at.top, at.left, at.bottom, at.right),
            "pitch"_a = py::make_tuple(at.row_pitch, at.col_pitch),
            "spacing"_a = py::make_tuple(at.spacing_v, at.spacing_h),
            "origin"_a = py::make_tuple(at.origin_v, at.origin_h), "gains"_a = gains));
    }
    return list;
}

void bind_profiles(py::module_& m)
{
    m.def("profile_from_dng", &profile_from_dng, "metadata"_a,
          "The sensor profile that one reference DNG amounts to.");
    m.def(
        "profile_from_dngs",
        [](const std::vector<DngMetadata>& files, const std::string& id) {
            ProfileOfDngs made = profile_from_dngs(files, id);
            return py::make_tuple(std::move(made.profile), std::move(made.notes));
        },
        "metadata"_a, "id"_a = "",
        "(SensorProfile, notes) that DNGs of one camera amount to: all their neutrals, "
        "a row\n"
        "of noise per ISO, the mean of their GainMaps; notes say what they lack, and "
        "its cost.\n"
        "id: lower-case letters, digits, '-' and '.'; empty: from the model.\n\n"
        "Raises ValueError naming the files that are not of one camera.");
}

void bind_metadata(py::module_& m)
{
    py::class_<DngMetadata>(m, "DngMetadata",
                            "What one DNG says of its camera and shot.")
        .def_readonly("file", &DngMetadata::file, "Path it was read from.")
        .def_readonly("make", &DngMetadata::make, "Maker; may be empty.")
        .def_readonly("model", &DngMetadata::model, "Model; may be empty.")
        .def_readonly("unique_camera_model", &DngMetadata::unique_camera_model,
                      "DNG UniqueCameraModel; may be empty.")
        .def_property_readonly(
            "active_area",
            [](const DngMetadata& d) {
                return std::array<int, 2> { d.active_area.width, d.active_area.height };
            },
            "(width, height), pixels.")
        .def_property_readonly(
            "cfa", [](const DngMetadata& d) { return name_of(d.cfa); },
            "Filters of the repeat from the top-left active pixel on: RGGB; MONO: "
            "none.")
        .def_readonly("bits", &DngMetadata::bits, "That white_level needs, 8 to 16.")
        .def_readonly("black_level", &DngMetadata::black_level, "DN, per CFA site.")
        .def_readonly("white_level", &DngMetadata::white_level, "DN at saturation.")
        .def_property_readonly(
            "calibrations",
            [](const DngMetadata& d) { return list_of(d.calibrations); },
            "One or two {\"light_source\" (EXIF code), \"camera_from_xyz\", "
            "\"xyz_d50_from_camera\"}:\n(3, 3) ColorMatrix and (3, 3) ForwardMatrix or "
            "None.")
        .def_readonly("as_shot_neutral", &DngMetadata::as_shot_neutral,
                      "Camera RGB of a neutral patch, G = 1; None: not said.")
        .def_property_readonly(
            "noise_profile",
            [](const DngMetadata& d) {
                std::vector<std::array<double, 2>> pairs;
                for (const NoisePair& p : d.noise_profile)
                    pairs.push_back({ p.scale, p.offset });
                return pairs;
            },
            "(scale, offset) of sd = sqrt(scale x + offset), x in 0..1, of R, G, B; "
            "empty: none.")
        .def_property_readonly(
            "gain_maps", [](const DngMetadata& d) { return list_of(d.gain_maps); },
            "GainMaps of OpcodeList2: dicts of sites (of the CFA, row major), area\n"
            "(top, left, bottom, right in pixels of the active area), pitch (rows, "
            "cols),\n"
            "spacing and origin of the points (vertical, horizontal, 1 = the active "
            "area)\n"
            "and gains ((rows, cols) float32, above 0).")
        .def_readonly("notes", &DngMetadata::notes,
                      "What was missing or simplified, one sentence each.")
        .def_property_readonly(
            "shot", [](const DngMetadata& d) { return dict_of(d.shot); },
            "{\"exposure_time\" (s), \"f_number\", \"focal_length\" (mm), \"iso\", "
            "\"date_time_original\",\n\"orientation\"} of Exif, \"pixel_aspect\", and "
            "\"frame_rate\", "
            "\"time_code\", \"reel_name\", \"camera_label\"\nas write_dng takes them; "
            "None or empty: not said.")
        .def(
            "merged_shot",
            [](const DngMetadata& d, const Shot& of_image) {
                return merged(d.shot, of_image);
            },
            "of_image"_a,
            "The Shot of a file for which this one is the reference: its Exif, and of "
            "the\nimage what it lacks. Orientation, author, rights and description are "
            "the image's,\nas is the frame's place in a shot: frame rate, time code, "
            "reel "
            "and camera label.");
    m.def(
        "is_dng", [](const std::string& path) { return is_dng(path); }, "path"_a,
        "Whether a file is a DNG, also one that cannot be read.");
    m.def("read_dng_metadata", &read, "path"_a, "cfa"_a = "",
          "Metadata of a DNG; no pixels are read.\n\n"
          "cfa: of a demosaicked file (LinearRaw, ProRAW), which does not say it: RGGB "
          "...\n"
          "Raises ValueError naming file, tag, value and bound. Source: DNG "
          "specification 1.7.1.");
}

} // namespace

void write_frame(const std::string& path, const RawArray& raw,
                 const Simulation& simulation, const DngOptions& options,
                 const Shot& shot, int threads, bool drawn)
{
    const Size frame = simulation.frame();
    if (raw.ndim() != 2 || raw.shape(0) != frame.height || raw.shape(1) != frame.width)
        throw Error("raw must keep the shape that it was simulated with: ("
                    + std::to_string(frame.height) + ", " + std::to_string(frame.width)
                    + ")");
    const auto* const end = raw.data() + raw.size();
    if (raw.size() > 0
        && *std::max_element(raw.data(), end) > simulation.profile().white_level)
        throw Error("raw holds DN above the sensor's white level "
                    + std::to_string(simulation.profile().white_level));
    const Plane<const std::uint16_t> plane { raw.data(), frame.width, frame.height,
                                             frame.width };
    const py::gil_scoped_release release;
    DngDescription description = describe(simulation, options, shot);
    if (!drawn) { // the caller's DN: nobody knows how they were made
        Origin& origin = description.origin;
        origin.seed = std::nullopt;
        origin.frame = std::nullopt;
        origin.digital_gain = std::nullopt;
        origin.exposure = std::nullopt;
        origin.convention.clear();
    }
    write_dng(path, plane, description, options, parallel_threads(threads));
}

void bind_dng(py::module_& m)
{
    m.def("write_dng", &write, "path"_a, "raw"_a, "simulation"_a, "compression"_a,
          "preview"_a, "matrices"_a, "tone_curve"_a, "threads"_a, "shot"_a,
          "sync"_a = true, "drawn"_a = true, "crop"_a = "border",
          "shading"_a = py::none(), "Write a DNG; see cg2raw.write_dng.");
    bind_metadata(m);
    bind_profiles(m);
}

} // namespace cg2raw::python

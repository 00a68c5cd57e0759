// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file 7 - An image and the options of its user -> all that decides a DNG. One set of
/// rules for the plugin, the commands and Python.
#pragma once

#include "cg2raw/dng_writer.h"
#include "cg2raw/encoding.h"
#include "cg2raw/scene_file.h"
#include "cg2raw/spectral_image.h"

#include <functional>
#include <map>
#include <variant>

namespace cg2raw {

/// What a file or its host states of an image, by OpenImageIO's names ("ExposureTime",
/// "smpte:TimeCode"): texts, and numbers. A rational number is the text "24000/1001", a
/// packed time code its two words. Upper and lower case are alike.
class Metadata {
public:
    /// Of a type of their own, for libstdc++ 12: of a variant of texts and vectors it
    /// destroys what it has not made where memory for a copy is refused.
    struct Numbers {
        Numbers(std::vector<double> numbers = {})
            : values(std::move(numbers))
        {
        }
        std::vector<double> values;
    };
    using Value = std::variant<std::string, Numbers>;

    /// Of two of one name the first counts.
    void add(std::string_view name, Value value);
    /// nullptr: it is not stated.
    const Value* find(std::string_view name) const;
    /// Empty: it is not stated.
    std::string text(std::string_view name) const;
    /// The first of some names that is stated and not empty.
    std::string text(std::initializer_list<const char*> names) const;
    /// One number, which a text may hold, too; 0: it is not stated.
    double number(std::string_view name) const;
    /// All of them, by names in lower case.
    const std::map<std::string, Value>& values() const { return m_values; }

private:
    std::map<std::string, Value> m_values;
};

/// One image of a file: a part of a multi-part OpenEXR file, or all of a simple one.
struct ImagePart {
    ScenePart names; ///< of the part and its channels
    std::string samples; ///< OpenImageIO's name of their type in the file: "half"
    bool is_flat = true; ///< false: deep, or a volume
    Metadata metadata {};
};

/// What is known of an image before its first pixel.
struct ImageFacts {
    std::vector<ImagePart> parts; ///< one or more
    /// Paths; empty: not known. Numbers in them are frame numbers.
    std::string input_name, output_name;
    /// Frames from the first of its shot; none: by the frame number.
    std::optional<std::int64_t> place;
    int output_bits = 0; ///< that the host wants of a sample; 0: no matter
    int openimageio_version; ///< OIIO_VERSION
    /// The light that a word such as "estimate:mean" finds in bins of the whole image;
    /// empty: the host does not have all of it.
    std::function<Spectrum(const std::string& word, const SpectralChannels& bins)>
        measured_light {};
};

/// How messages name what their reader can change, and what OpenColorIO's current
/// config says. Everything is looked up only where it is needed.
struct Dialect {
    /// An option with a value, as it is typed: iso, "800" -> "--attrib dng:iso 800". By
    /// its name alone if the value is empty: "dng:iso".
    std::function<std::string(std::string_view name, std::string_view value)> option;
    /// Whether "linear" or "scene_linear" is Rec.709.
    std::function<bool(const std::string& word)> is_rec709;
    /// A space that is scene-linear Rec.709.
    std::function<std::string()> rec709;
    std::string is_linear; ///< what says that pixels are: "--iscolorspace lin_rec709"
    bool converts = false; ///< the same command has --tocolorspace
};

/// An option of an export, as its user sees it.
struct ExportOption {
    const char* name; ///< "iso"
    const char* group; ///< of command lines: "exposure", "input", "shot", "file"
    const char* type; ///< "text", "word", "number", "integer", "flag"
    const char* allowed; ///< "an ISO from 1 to 10000000", for messages and pages
    const char* description; ///< Markdown
};

/// All of them.
const std::vector<ExportOption>& export_options();

/// The options of one image as they were given; absent ones are empty.
struct ExportOptions {
    std::string sensor, reference, illuminant, layer;
    std::optional<double> iso, digital_gain;
    std::optional<ExposureRule> exposure;
    std::optional<double> exposure_time, f_number, scene_luminance, nd_filter, bracket;
    std::optional<Limits> time_limits, f_number_limits, iso_limits;
    std::optional<double> white_luminance; ///< of spectral images, cd/m2
    std::optional<bool> highlights;
    std::optional<Convention> convention;
    std::optional<NoiseModel> noise;
    std::optional<Compression> compression;
    bool sample_digital_gain = false;
    Undo undo = Undo::none; ///< linearize: the curve of sRGB
    std::uint64_t seed = 0;
    std::optional<std::int64_t> frame;
    std::optional<FrameRate> frame_rate;
    std::optional<TimeCode> time_code; ///< of first_frame
    std::optional<std::int64_t> first_frame;
    std::string reel, camera_label;
    bool effects = true;
    DngOptions file;

    /// Sets the option of this name by a text. Throws Error naming the option, as
    /// @p dialect does, the text and what is allowed.
    void set(std::string_view name, const std::string& text, const Dialect& dialect);
};

/// Everything that decides a file.
struct Export {
    SceneLayer layer {}; ///< the channels to take, and their part
    Curve curve {}; ///< that is undone
    Decoder decoder {}; ///< of their numbers
    std::optional<SpectralChannels> bins {}; ///< of spectra, which are taken instead
    std::optional<SpectralResponse> spectral {}; ///< of them
    SensorProfile profile {};
    Run run {};
    DngOptions file {};
    Shot shot {};
};

/// The layer of a file that is its picture, or that an option names. Throws Error.
SceneLayer picture_layer(const ImageFacts& facts, const ExportOptions& options,
                         const Dialect& dialect);

/// The bins of a spectrum among the channels of an image. Throws Error, also if it is
/// not flat.
std::optional<SpectralChannels> spectral_bins(const ImagePart& part);

/// The light's spectrum that an image states in its attribute "illuminant". Throws
/// Error for a text that is none.
std::optional<Spectrum> stated_light(const Metadata& metadata);

/// The luminance of white that an image states, cd/m2.
std::optional<double> stated_white(const Metadata& metadata);

/// What an image states of its exposure and of its place in a shot. @p rate: of which
/// its time code is; none: as it is stated.
Shot stated_shot(const Metadata& metadata,
                 const std::optional<FrameRate>& rate = std::nullopt);

/// Decides all of an export. The frame number is the option's, else that in the
/// output's name, else the time code, else that in the input's name, else 0. Throws
/// Error for a value out of range, a contradiction, channels that are no picture, or a
/// colour space that is neither RAW nor scene-linear Rec.709.
Export resolve(const ImageFacts& facts, const ExportOptions& options,
               const Dialect& dialect);

/// The same without a camera: the picture, even where there is a spectrum, its frame
/// number and its shot.
Export resolve_picture(const ImageFacts& facts, const ExportOptions& options,
                       const Dialect& dialect);

} // namespace cg2raw

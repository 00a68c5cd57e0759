// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What the numbers of an image file mean: which curve encodes them, whether
/// alpha is multiplied in, and the light that they stand for. One rule for the plugin,
/// the commands and Python.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace cg2raw {

/// What a file, or its user, says of its pixels' encoding.
struct StatedEncoding {
    std::string space; ///< name of the colour space; empty if there is none
    bool is_rec709 = false; ///< whether @p space means scene-linear Rec.709
    bool is_raw = false; ///< whether @p space is a RAW space
    std::string samples; ///< OpenImageIO's name of their type: "uint8", "half"
    std::string icc_profile; ///< description of an ICC profile; empty if there is none
    std::string transfer; ///< DPX: its transfer characteristic, in OpenImageIO's words
    double gamma = 0.0; ///< the exponent that the file states; 0 if there is none
};

/// Which curves are undone.
enum class Undo {
    none, ///< none is: pixels that a curve encodes are an error
    srgb, ///< sRGB's, as it was asked for: other pixels are an error
    stated, ///< the one that the file states; an error if whole numbers state none
    stated_or_srgb, ///< the same, but whole numbers that state none are sRGB
};

/// "none", "srgb", "stated" or "stated-or-srgb". Throws Error for other words.
Undo undo_from_name(std::string_view name);

/// How a user says what a file does not, for messages.
struct EncodingWords {
    std::string linearize; ///< "--linearize srgb"
    std::string is_linear; ///< "--iscolorspace lin_rec709"
    /// "oiiotool --tocolorspace lin_rec709"; looked up only for a message.
    std::function<std::string()> convert;
};

/// The curve from light to the numbers of a file.
struct Curve {
    enum class Kind { none, srgb, power } kind = Kind::none;
    double exponent = 1.0; ///< of a power: light = code ^ exponent

    /// "srgb", "g2.2", or nothing.
    std::string name() const;
};

/// Whether a colour space's name is one that OpenImageIO or a common config gives to
/// Rec.709 colours behind the curve of sRGB; upper and lower case do not matter.
bool is_srgb_name(std::string_view space);

/// The curve to undo. Floats that state nothing are linear light; whole numbers that
/// state nothing are an error, unless @p undo says that they are sRGB. Throws Error,
/// with the remedy, for pixels that are not scene-linear Rec.709 or RAW then, and where
/// @p undo is srgb and there is no such curve.
Curve curve_of(const StatedEncoding& said, Undo undo, const EncodingWords& words);

/// Code values of whole numbers: 256 or 65536; 0 of floats; -1 of others.
int levels_of(std::string_view samples);

/// How colour and alpha go together.
enum class Alpha {
    none, ///< there is no alpha
    associated, ///< colour is multiplied by alpha, as in OpenEXR
    unassociated, ///< colour is not multiplied by alpha, as in PNG
};

/// Numbers of a file -> light over black. The curve is undone before colour is
/// multiplied by alpha; where alpha is multiplied in already, it is divided out before.
/// Colour under an unassociated alpha of 0 is black, NaN too; under an associated one
/// it shines. Of whole numbers, those that are code values but for the rounding of
/// float count as such. The same light on any machine, correctly rounded but for
/// float64's own error.
class Decoder {
public:
    /// Linear light without alpha, which remains as it is.
    Decoder() = default;
    /// @p levels: as levels_of() has them; below 1 those of floats.
    Decoder(const Curve& curve, Alpha alpha, int levels);

    bool is_identity() const;
    bool needs_alpha() const { return m_needs_alpha; }
    /// Decodes @p count pixels, whose R, G, B lie together; @p alpha is of the first
    /// one, with @p pitch floats to the next, and may be null unless it is needed.
    void decode(float* rgb, const float* alpha, std::ptrdiff_t pitch, int count) const;

private:
    int code_of(float number) const;
    double value_of(float number) const;
    float light_of(float number) const;

    Curve m_curve;
    Alpha m_alpha = Alpha::none;
    bool m_needs_alpha = false;
    int m_top = 0; ///< the largest code value; 0 of floats
    std::vector<float> m_light; ///< of each code value
};

} // namespace cg2raw

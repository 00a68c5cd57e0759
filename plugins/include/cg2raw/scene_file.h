// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What the names in and of a render say: which channels are its picture, and
/// which frame of a shot it is. One rule for the plugin, the commands and Python.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cg2raw {

/// One image of a file: a part of a multi-part OpenEXR file, or all of a simple one.
struct ScenePart {
    std::string name; ///< empty: its number stands for it
    std::vector<std::string> channels; ///< as the file names them: "diffuse.R"
};

/// Three channels that are one picture.
struct SceneLayer {
    std::string name; ///< empty: unnamed channels R, G, B
    int part = 0; ///< index of the part that they lie in
    std::array<int, 3> channels {}; ///< of R, G and B, in that part
    int alpha = -1; ///< its alpha in that part, -1 if it has none
};

/// What else a host knows of a file, for messages.
struct LayerHints {
    /// An option that names a layer: "--layer NAME".
    std::function<std::string(const std::string& name)> option;
    bool other_parts = false; ///< the file has parts that are not among those given
    std::vector<std::string>
        data; ///< layers that start so are no pictures: Cryptomatte
};

/// What is wrong with a file of a camera, where a render is needed.
inline constexpr const char* raw_already
    = "is RAW already, a camera's mosaic or its colours, and no scene-linear picture: "
      "develop it first (oiiotool -iconfig dng:developed 1 IN.dng -o OUT.exr, or a RAW "
      "converter that writes linear Rec.709)";

/// The picture ("beauty") among all layers of a file. A layer is what stands before the
/// last dot of a channel's name, with the part's name before it where the file has
/// several; R, G, B (or red, green, blue) of one layer may stand in any order, among
/// any others.
///
/// @p asked, if not empty, is the layer's name, upper and lower case alike; its
/// channels may be x, y, z or 0, 1, 2 too, and channels without names are it. Else it
/// is, in this order: the only layer of a file that has nothing else; unnamed R, G, B;
/// the one that is called rgba, rgb, beauty, C, Ci or Combined; the one whose name ends
/// so, as in ViewLayer.Combined. Three or four channels without names are R, G, B, A.
/// Throws Error, with the names found and what to add, if none or several are; layers
/// whose names say that they are data (normals, ids, depth ...) are not suggested.
///
/// Sources: OpenEXR, "Technical Introduction" (layers; R, G, B of no layer are the
/// picture); what Arnold (RGBA), Blender (Combined), Karma and Mantra (C), Nuke (rgba),
/// RenderMan (Ci) and V-Ray (unnamed) write.
SceneLayer beauty_layer(const std::vector<ScenePart>& parts, std::string_view asked,
                        const LayerHints& hints);

/// The path of a frame of a shot: its number, and the text before and after it.
struct FrameName {
    std::string before;
    std::int64_t number;
    std::string after;
};

/// The frame number in the name of a file of a shot, nothing if there is none: the last
/// part of the name that is all digits ("shot.0007.beauty.exr": 7), else the digits
/// that it ends with ("render0007.exr": 7), unless they are a version's ("comp_v002").
/// A "-" that begins the name or follows one of ". _ -" or a space is a sign
/// ("shot.-0007.exr": -7, but "shot-0007.exr": 7). Folders and the extension do not
/// count. Numbers have at most 18 digits.
std::optional<FrameName> frame_name(std::string_view path);

/// The frame number that an SMPTE time code stands for, "hh:mm:ss:ff" or with ";" where
/// frames are dropped: its digits, hhmmssff, so that each frame of 24 hours has its own
/// at any rate. Nothing for other texts. Source: SMPTE ST 12-1.
std::optional<std::int64_t> frame_from_time_code(std::string_view text);

} // namespace cg2raw

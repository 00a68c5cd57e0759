// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file 3 - Scene linear -> camera RGB under an illuminant, in four conventions.
#pragma once

#include "cg2raw/illuminant.h"

namespace cg2raw {

enum class Convention {
    dng, ///< exact inverse of a DNG renderer (default)
    paper, ///< as the published reference implementation of Graphics2RAW computes it
    sensor, ///< light as it enters a camera: dng, but nothing clips before the sensor
    spectral, ///< sensor, of reflectances that the sensitivities see under the light
};
Convention convention_from_name(std::string_view name);
const char* name_of(Convention convention);

/// Balanced camera RGB from the seven terms of transform_uplift.h.
using UpliftMatrix = std::array<std::array<double, 7>, 3>;

/// Scene-linear Rec.709 -> camera RGB, decided before the first pixel:
/// balanced = clip(second clip(first scene)), camera = highlights(balanced, gains).
struct CameraTransform {
    Mat3 first; ///< dng: balanced camera from sRGB; paper: XYZ from sRGB
    bool two_steps; ///< paper: clip to 0..1 between the two products
    Mat3 second; ///< paper: balanced camera from XYZ; dng: identity
    std::array<double, 3> gains; ///< g_c, white balance undone, times the digital gain
    bool keep_highlights; ///< false: camera = balanced * gains
    bool clip_result; ///< paper: clip to 0..1 after the gains
    bool is_light; ///< sensor, spectral: clip() is at 0 alone, no highlights are kept
    bool is_grey; ///< monochrome: the planes are one, and no inverse tells colours
    float exposure = 1.0f; ///< gain on scene-linear values, before all else
    std::optional<UpliftMatrix> uplift {}; ///< spectral: in place of first
    std::string spectrum {}; ///< spectral: the light whose power was taken
};

/// The transform of @p profile under @p illuminant; of a monochrome sensor, luminance
/// (CIE Y) in all planes, white 1, whatever the light. Throws Error, also for the
/// paper's convention and a monochrome sensor.
CameraTransform camera_from_scene(const SensorProfile& profile,
                                  const Illuminant& illuminant, Convention convention,
                                  double digital_gain = 1.0,
                                  bool keep_highlights = true);

/// Camera RGB -> scene-linear Rec.709, as the processor of a camera does it: white
/// balance, clip at white, colour matrix. scene = second clip(first clip(camera /
/// gains)), not clipped. The inverse of the transform it is made of, but for what
/// clipped and for highlights that were kept white: those come out no brighter than 1.
/// Of a monochrome sensor the scene comes back grey.
struct SceneTransform {
    std::array<double, 3> gains;
    Mat3 first; ///< dng: identity; paper: XYZ from balanced camera
    bool two_steps; ///< paper: clip to 0..1 between the two products
    Mat3 second; ///< dng: sRGB from balanced camera; paper: sRGB from XYZ
};
/// Throws Error for a transform that has no inverse.
SceneTransform scene_from_camera(const CameraTransform& camera_from_scene);

/// Linear sRGB from balanced camera RGB (white = 1, 1, 1), for pictures of a RAW.
Mat3 srgb_from_balanced(const SensorProfile& profile, const Illuminant& illuminant);

/// T and xy as the paper's reference implementation iterates them; not a true CCT.
Temperature paper_temperature(const SensorProfile& profile, const Vec3& neutral);

/// Legal pixels out of any: NaN -> 0, infinities -> +-1e6; counts what was not finite.
struct Illegal {
    long nan = 0, inf = 0;

    Illegal& operator+=(const Illegal& more)
    {
        nan += more.nan;
        inf += more.inf;
        return *this;
    }
};

/// One row of scene pixels -> three planes of camera RGB, each @p width floats.
/// @p scene steps by @p pixel_stride floats. Adds to @p illegal.
void to_camera(const CameraTransform& transform, const float* scene,
               std::ptrdiff_t pixel_stride, int width, float* const camera[3],
               Illegal& illegal);
/// The way back: one row of camera RGB -> three planes of scene-linear Rec.709.
void to_scene(const SceneTransform& transform, const float* camera,
              std::ptrdiff_t pixel_stride, int width, float* const scene[3],
              Illegal& illegal);
/// to_camera() for pixels that already are camera RGB: they are only exposed, and made
/// legal.
void copy_camera(const float* scene, std::ptrdiff_t pixel_stride, int width,
                 float exposure, float* const camera[3], Illegal& illegal);

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file 6 - A mosaic and what is known of it -> a DNG file, complete or absent.
#pragma once

#include "cg2raw/parallel.h"
#include "cg2raw/simulation.h"

namespace cg2raw {

enum class Compression { none, ljpeg };
Compression compression_from_name(std::string_view name);

/// Which colour matrices the file carries.
enum class Matrices {
    camera, ///< the sensor's own
    exact, ///< one synthetic matrix by which every reader gives the render back
};
Matrices matrices_from_name(std::string_view name);

enum class ToneCurve {
    camera, ///< none in the file: the reader's own
    linear, ///< ProfileToneCurve (0,0,1,1) and DefaultBlackRender 1
};
ToneCurve tone_curve_from_name(std::string_view name);

struct DngOptions {
    Compression compression = Compression::ljpeg;
    bool preview = true;
    Matrices matrices = Matrices::camera;
    ToneCurve tone_curve = ToneCurve::camera;
    /// The file is on the disk before it has its name, so that not even a loss of power
    /// leaves a partial one; false for files that are checked and made again.
    bool sync = true;
};

/// Noise of one colour plane as NoiseProfile has it: sd = sqrt(scale x + offset), x in
/// 0..1.
struct NoisePair {
    double scale, offset;
};

/// Gains that undo lens shading, on a regular grid over the active area, one map for
/// all sites. Row major.
struct GainMap {
    int rows, cols;
    std::vector<float> gains;
};

/// What Exif says of the exposure; absent fields are not written.
struct Shot {
    std::optional<double> exposure_time; ///< s
    std::optional<double> f_number;
    std::optional<double> focal_length; ///< mm
    std::optional<int> iso;
    std::string date_time_original; ///< "YYYY:MM:DD HH:MM:SS" or empty
    std::string artist, copyright, description, lens_model;
    int orientation = 1; ///< Exif orientation, 1 to 8
};

/// Without what makes no sense in Exif: dates of another form, orientations but 1 to 8,
/// numbers outside 1e-6 to 1e6. It is no reason to refuse a picture.
Shot plausible(Shot shot);

/// All that a file says of its pixels.
struct DngDescription {
    Size size; ///< of the active area, which is the whole mosaic
    /// Repeats of 2x2 and 6x6 are demosaicked by LibRaw, dcraw, RawTherapee and
    /// darktable; of 4x4 by none of them, though LibRaw reads its DN.
    CfaPattern cfa;
    /// DN per CFA site. Levels that differ on 6x6 are subtracted by LibRaw and dcraw;
    /// RawTherapee 5.9 and darktable 4.2 know no more than 2x2 of them.
    std::vector<double> black_level;
    int white_level; ///< DN
    std::vector<Calibration> calibrations;
    Vec3 as_shot_neutral; ///< G = 1
    std::string make, model, unique_camera_model;
    std::vector<NoisePair> noise_profile; ///< empty, or one per colour plane R, G, B
    /// Against lens_shading and color_shading, per colour R, G, B.
    std::optional<std::array<GainMap, 3>> shading_gains;
    Mat3 srgb_from_balanced; ///< for the preview
    Shot shot;
};

/// What the file of a simulation says: matrices per @p options, noise and shading of
/// the active effects.
DngDescription describe(const Simulation& simulation, const DngOptions& options,
                        const Shot& shot);

/// Writes one DNG, row by row. Nothing appears under @p path before close() succeeds;
/// an unfinished file is removed by the destructor.
class DngWriter {
public:
    /// Throws Error: unwritable folder, sizes below 2x2 or above 65535, bad
    /// description.
    DngWriter(const std::string& path, const DngDescription& description,
              const DngOptions& options, ParallelFor parallel = parallel_threads(1));
    ~DngWriter();
    DngWriter(const DngWriter&) = delete;
    DngWriter& operator=(const DngWriter&) = delete;

    /// The next rows, top to bottom, DN. Throws Error with the system's reason.
    void write_rows(const Plane<const std::uint16_t>& rows);
    /// Publish. Throws Error if rows are missing or the system refuses.
    void close();

private:
    struct State;
    std::unique_ptr<State> m_state;
};

/// The whole file at once.
void write_dng(const std::string& path, const Plane<const std::uint16_t>& raw,
               const DngDescription& description, const DngOptions& options,
               ParallelFor parallel = parallel_threads(1));

} // namespace cg2raw

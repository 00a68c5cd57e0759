// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file 6 - A mosaic and what is known of it -> a DNG file, complete or absent.
#pragma once

#include "cg2raw/dng_description.h"
#include "cg2raw/parallel.h"
#include "cg2raw/simulation.h"

namespace cg2raw {

enum class Compression {
    none,
    ljpeg, ///< lossless JPEG that every reader knows
    ljpeg_2d, ///< the smallest lossless JPEG; RawSpeed, of darktable, refuses it
};
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

/// What undoes the lens shading that lies in the pixels.
enum class Shading {
    tagged, ///< GainMaps, for readers that know them
    baked, ///< nothing: all readers show it
};
Shading shading_from_name(std::string_view name);

/// What DefaultCrop leaves out of the picture that converters show.
enum class Crop {
    border, ///< 2 pixels on each side of pictures of at least 16 x 16
    none, ///< nothing: all pixels are shown
};
Crop crop_from_name(std::string_view name);

struct DngOptions {
    Compression compression = Compression::ljpeg;
    /// A picture in IFD 0; none: one unless it is a frame of a shot, whose IFD 0 is
    /// RAW, as players want it.
    std::optional<bool> preview = std::nullopt;
    Matrices matrices = Matrices::camera;
    ToneCurve tone_curve = ToneCurve::camera;
    /// None: tagged, but baked in a frame of a shot, whose players know no GainMaps.
    std::optional<Shading> shading = std::nullopt;
    /// The file is on the disk before it has its name, so that not even a loss of power
    /// leaves a partial one; false for files that are checked and made again.
    bool sync = true;
    Crop crop = Crop::border;
};

/// What the file of a simulation says: matrices and shading per @p options, noise of
/// the active effects, its origin.
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

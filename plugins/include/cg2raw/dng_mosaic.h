// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The pixels of a DNG: its mosaic, and the picture that it develops to.
#pragma once

#include "cg2raw/dng_reader.h"
#include "cg2raw/parallel.h"

#include <istream>
#include <memory>

namespace cg2raw {

/// How a mosaic is stored, and what DngMetadata leaves out of its file's tags.
struct DngStorage {
    Size size; ///< of all stored pixels, a masked border included
    Site active_area; ///< its top-left corner; its size is in DngMetadata
    int bits; ///< of a stored sample, 8 to 16
    bool is_jpeg; ///< lossless JPEG; else uncompressed
    bool is_linearised; ///< values went through the file's LinearizationTable
    /// DefaultCropOrigin and DefaultCropSize, horizontal first; pixels of active_area.
    std::optional<std::array<double, 2>> crop_origin, crop_size;
    std::optional<std::array<double, 2>> default_scale; ///< horizontal first
    std::array<int, 4> version; ///< DNGVersion
    std::string software, date_time; ///< may be empty
    std::string xmp; ///< the packet, undecoded; may be empty
};

/// Whether the bytes are of a TIFF or BigTIFF whose first directory, or what is left of
/// it, has DNGVersion or DNGBackwardVersion: any DNG, damaged ones too. Never throws.
bool is_dng(std::istream& bytes) noexcept;
bool is_dng(const std::string& path) noexcept;

/// The mosaic of one DNG: CFA or monochrome, 8 to 16 bits, in strips or tiles, without
/// compression or as lossless JPEG. One thread at a time.
class DngMosaic {
public:
    /// Reads directories alone. @p dng must outlive it and be able to seek; @p name
    /// names it in messages. Throws Error, naming file, tag, value and bound, for what
    /// is missing, malformed or unknown, and for pixels that the file cannot hold.
    DngMosaic(std::istream& dng, const std::string& name);
    ~DngMosaic();
    DngMosaic(const DngMosaic&) = delete;
    DngMosaic& operator=(const DngMosaic&) = delete;

    const DngMetadata& metadata() const;
    const DngStorage& storage() const;

    /// Rows @p first and on of all that is stored -> DN as the file has them, or as its
    /// LinearizationTable makes them: those that black and white level are in. Keeps a
    /// row of tiles of lossless JPEG. Throws Error for pixels that are damaged.
    void read_rows(int first, const Plane<std::uint16_t>& rows,
                   const ParallelFor& parallel = parallel_threads(1));

private:
    struct State;
    std::unique_ptr<State> m_state;
};

/// A picture of a DNG: black and white level, bilinear interpolation (Demosaic),
/// AsShotNeutral, clipped at white, and the file's own matrices to linear Rec.709. Of a
/// monochrome sensor all channels are its grey. No exposure, no tone curve, no opcodes:
/// lens shading stays. It is the inverse of Convention::dng but for the noise.
class DevelopedDng {
public:
    /// @p mosaic must outlive it. Throws Error for a DNG without a neutral.
    explicit DevelopedDng(DngMosaic& mosaic);
    ~DevelopedDng();

    Size size() const; ///< that of the active area
    /// Rows @p first and on -> R, G, B, 1 is the white that clips; negative values are
    /// kept. @p pitch counts floats from row to row. The first call reads all of the
    /// mosaic, and keeps it as floats.
    void read_rows(int first, int count, float* rgb, std::ptrdiff_t pitch,
                   const ParallelFor& parallel = parallel_threads(1));

private:
    struct State;
    std::unique_ptr<State> m_state;
};

} // namespace cg2raw

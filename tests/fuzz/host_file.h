// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file A host's ImageOutput, and what must hold of each of its calls.
#pragma once

#include "scratch_folder.h"

#include <OpenImageIO/imageio.h>

#include <memory>
#include <set>
#include <string>
#include <vector>

namespace cg2raw::test {

/// A file of the plugin, in a folder for it alone. Its functions throw Finding for a
/// call that fails without a message or with one that does not name the file, for what
/// is no whole DNG, and for what lies beside it.
class HostFile {
public:
    explicit HostFile(const ScratchFolder& folder);
    ~HostFile();

    /// Does nothing for images of more than most_pixels that the plugin may take, or of
    /// which no host could hold a row.
    void open(const std::string& name, const OIIO::ImageSpec& spec,
              OIIO::ImageOutput::OpenMode mode);
    void write_rows(int first, int end, OIIO::TypeDesc format);
    void write_tile(int x, int y, OIIO::TypeDesc format);
    void write_image(OIIO::TypeDesc format);
    void close();
    /// Destroys the output, whatever it was doing.
    void drop();
    /// Bytes between pixels from now on.
    void pad(int bytes);

    /// Whether any file is there.
    bool published() const { return !m_published.empty(); }

private:
    const char* data(std::size_t pixels, OIIO::TypeDesc format);
    OIIO::stride_t pixel_size(OIIO::TypeDesc format) const;
    void expect(bool done, bool is_ours);
    void check_folder() const;
    void check_file() const;

    const ScratchFolder& m_folder;
    std::unique_ptr<OIIO::ImageOutput> m_output;
    OIIO::ImageSpec m_spec; ///< as it was opened
    std::string m_name; ///< of the file that was opened last
    int m_pad = 0;
    bool m_is_open = false, m_has_failed = false;
    std::set<std::string> m_published;
    std::vector<char> m_data;
};

} // namespace cg2raw::test

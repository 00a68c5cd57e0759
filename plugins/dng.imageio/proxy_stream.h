// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The bytes that OpenImageIO hands over, as a stream of the standard library.
#pragma once

#include <OpenImageIO/filesystem.h>

#include <array>
#include <istream>
#include <streambuf>

namespace cg2raw {

/// Of an IOProxy that is open for reading, a file's or memory's, and outlives it. What
/// is larger than a buffer goes straight to where it is wanted.
class ProxyBuffer final : public std::streambuf {
public:
    explicit ProxyBuffer(OIIO::Filesystem::IOProxy& bytes);

private:
    int_type underflow() override;
    std::streamsize xsgetn(char* to, std::streamsize count) override;
    pos_type seekoff(off_type offset, std::ios_base::seekdir from,
                     std::ios_base::openmode which) override;
    pos_type seekpos(pos_type position, std::ios_base::openmode which) override;

    std::int64_t position() const { return m_next - (egptr() - gptr()); }
    void drop_buffer() { setg(nullptr, nullptr, nullptr); }

    OIIO::Filesystem::IOProxy& m_bytes;
    std::array<char, 4096> m_buffer;
    std::int64_t m_next = 0; ///< byte of the file behind the buffer
};

/// The same as a stream.
class ProxyStream final : public std::istream {
public:
    explicit ProxyStream(OIIO::Filesystem::IOProxy& bytes)
        : std::istream(nullptr)
        , m_buffer(bytes)
    {
        rdbuf(&m_buffer);
    }

private:
    ProxyBuffer m_buffer;
};

} // namespace cg2raw

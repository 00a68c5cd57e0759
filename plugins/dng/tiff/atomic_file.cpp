// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "tiff/atomic_file.h"

#include "cg2raw/types.h"

namespace cg2raw {

namespace {

/// Offsets of classic TIFF have 32 bits.
constexpr std::uint64_t tiff_limit = 0xffffffff;

} // namespace

AtomicFile::AtomicFile(std::string path, bool sync, bool unnamed)
    : m_path(std::move(path))
    , m_file(m_path, sync, unnamed)
{
}

bool AtomicFile::write(const void* data, std::size_t size,
                       std::uint64_t offset) noexcept
{
    if (offset + size > tiff_limit) {
        m_is_too_large = true;
        return false;
    }
    if (const std::error_code error = m_file.write(data, size, offset)) {
        if (!m_reason)
            m_reason = error;
        return false;
    }
    m_size = offset + size > m_size ? offset + size : m_size;
    return true;
}

std::size_t AtomicFile::read(void* data, std::size_t size,
                             std::uint64_t offset) noexcept
{
    return m_file.read(data, size, offset);
}

void AtomicFile::publish() { m_file.publish(); }

void AtomicFile::fail(const std::string& what, const std::string& otherwise) const
{
    const std::string reason = m_is_too_large
        ? "a TIFF file ends at 4 GiB: write a smaller image"
        : m_reason ? words_of(m_reason)
                   : otherwise;
    throw Error(m_path + ": cannot " + what + ": " + reason);
}

} // namespace cg2raw

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "proxy_stream.h"

#include <algorithm>
#include <cstring>

namespace cg2raw {

ProxyBuffer::ProxyBuffer(OIIO::Filesystem::IOProxy& bytes)
    : m_bytes(bytes)
{
    drop_buffer();
}

ProxyBuffer::int_type ProxyBuffer::underflow()
{
    const std::size_t got = m_bytes.pread(m_buffer.data(), m_buffer.size(), m_next);
    if (got == 0 || got > m_buffer.size())
        return traits_type::eof();
    m_next += std::int64_t(got);
    setg(m_buffer.data(), m_buffer.data(), m_buffer.data() + got);
    return traits_type::to_int_type(*gptr());
}

std::streamsize ProxyBuffer::xsgetn(char* to, std::streamsize count)
{
    const std::streamsize kept = std::min<std::streamsize>(egptr() - gptr(), count);
    if (kept > 0)
        std::memcpy(to, gptr(), std::size_t(kept));
    setg(eback(), gptr() + kept, egptr());
    if (kept == count)
        return count;
    if (count - kept < std::streamsize(m_buffer.size())) {
        if (underflow() == traits_type::eof())
            return kept;
        return kept + xsgetn(to + kept, count - kept);
    }
    const std::size_t got = m_bytes.pread(to + kept, std::size_t(count - kept), m_next);
    m_next += std::int64_t(got);
    drop_buffer();
    return kept + std::streamsize(got);
}

ProxyBuffer::pos_type ProxyBuffer::seekoff(off_type offset, std::ios_base::seekdir from,
                                           std::ios_base::openmode which)
{
    std::int64_t base = 0;
    if (from == std::ios_base::cur)
        base = position();
    else if (from == std::ios_base::end)
        base = std::int64_t(m_bytes.size());
    return seekpos(pos_type(base + offset), which);
}

ProxyBuffer::pos_type ProxyBuffer::seekpos(pos_type position, std::ios_base::openmode)
{
    if (off_type(position) < 0)
        return pos_type(off_type(-1));
    m_next = off_type(position);
    drop_buffer();
    return position;
}

} // namespace cg2raw

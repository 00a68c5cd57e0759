// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.
#include "tiff/client.h"

#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <type_traits>

namespace cg2raw {

namespace {

TiffClient& client_of(thandle_t handle) { return *static_cast<TiffClient*>(handle); }

tmsize_t read_proc(thandle_t handle, void* data, tmsize_t size)
{
    TiffClient& client = client_of(handle);
    const std::size_t done = client.file.read(data, std::size_t(size), client.position);
    client.position += done;
    return tmsize_t(done);
}

tmsize_t write_proc(thandle_t handle, void* data, tmsize_t size)
{
    TiffClient& client = client_of(handle);
    if (!client.file.write(data, std::size_t(size), client.position))
        return 0;
    client.position += std::uint64_t(size);
    return size;
}

toff_t seek_proc(thandle_t handle, toff_t offset, int whence)
{
    TiffClient& client = client_of(handle);
    const std::uint64_t from = whence == SEEK_END ? client.file.size()
        : whence == SEEK_CUR                      ? client.position
                                                  : 0;
    client.position = from + offset;
    return client.position;
}

toff_t size_proc(thandle_t handle) { return client_of(handle).file.size(); }

int close_proc(thandle_t) { return 0; } // the AtomicFile's own affair

int keep_complaint(TIFF*, void* user, const char*, const char* format,
                   std::va_list values)
{
    std::array<char, 512>& complaint = static_cast<TiffClient*>(user)->complaint;
    if (complaint.front() == '\0')
        std::vsnprintf(complaint.data(), complaint.size(), format, values);
    return 1; // dealt with: nothing goes to libtiff's global handlers
}

int drop_warning(TIFF*, void*, const char*, const char*, std::va_list) { return 1; }

template <class T> constexpr TIFFDataType type_of()
{
    if constexpr (std::is_same_v<T, Undefined>)
        return TIFF_UNDEFINED;
    else if constexpr (std::is_same_v<T, std::uint8_t>)
        return TIFF_BYTE;
    else if constexpr (std::is_same_v<T, std::uint16_t>)
        return TIFF_SHORT;
    else if constexpr (std::is_same_v<T, std::uint32_t>)
        return TIFF_LONG;
    else if constexpr (std::is_same_v<T, float>)
        return TIFF_FLOAT;
    else if constexpr (std::is_same_v<T, double>)
        return TIFF_DOUBLE;
    else if constexpr (std::is_same_v<T, Rational>)
        return TIFF_RATIONAL;
    else
        return TIFF_SRATIONAL;
}

/// The file's own declaration of a tag: any count, passed along. libtiff forgets it
/// with the IFD, so it is made anew for each. A global extender would reach the host's
/// files.
void declare(TIFF* tif, std::uint32_t number, TIFFDataType type)
{
    static char name[] = "DNG";
    const bool text = type == TIFF_ASCII;
    const short count = text ? TIFF_VARIABLE : TIFF_VARIABLE2;
    const TIFFFieldInfo info {
        number, count, count, type, FIELD_CUSTOM, 1, static_cast<unsigned char>(!text),
        name
    };
    TIFFMergeFieldInfo(tif, &info, 1);
}

/// One value of @p TIFFSetField, by the type and count that libtiff has for the tag.
class Setter {
public:
    Setter(TIFF* tif, std::uint32_t number)
        : m_tif(tif)
        , m_number(number)
    {
    }

    bool operator()(const std::string& text)
    {
        if (!known())
            declare(m_tif, m_number, TIFF_ASCII);
        return TIFFSetField(m_tif, m_number, text.c_str()) == 1;
    }
    bool operator()(const Undefined& value)
    {
        return set(value.bytes, type_of<Undefined>());
    }
    template <class T> bool operator()(const std::vector<T>& values)
    {
        if constexpr (std::is_same_v<T, Rational> || std::is_same_v<T, SignedRational>)
            return set_fractions(values);
        else
            return set(values, type_of<T>());
    }

private:
    const TIFFField* known() const { return TIFFFindField(m_tif, m_number, TIFF_ANY); }

    template <class T> bool set(const std::vector<T>& values, TIFFDataType type)
    {
        if (!known())
            declare(m_tif, m_number, type);
        const TIFFField* const field = known();
        if (!field)
            return false;
        if (TIFFFieldPassCount(field))
            return TIFFSetField(m_tif, m_number, int(values.size()), values.data())
                == 1;
        if (TIFFFieldWriteCount(field) == 1) // by value; C promotes float to double
            return TIFFSetField(m_tif, m_number, values.at(0)) == 1;
        return TIFFSetField(m_tif, m_number, values.data()) == 1;
    }

    /// As float32, in which libtiff keeps fractions; TiffFile makes them exact again.
    template <class T> bool set_fractions(const std::vector<T>& fractions)
    {
        if (!known())
            declare(m_tif, m_number, type_of<T>());
        const TIFFField* const field = known();
        std::vector<double> values(fractions.size());
        std::transform(
            fractions.begin(), fractions.end(), values.begin(),
            [](const T& f) { return double(f.numerator) / double(f.denominator); });
        if (field && TIFFFieldSetGetSize(field) == sizeof(double))
            return set(values, type_of<T>());
        return set(std::vector<float>(values.begin(), values.end()), type_of<T>());
    }

    TIFF* m_tif;
    std::uint32_t m_number;
};

} // namespace

tiff* open_tiff(TiffClient& client)
{
    TIFFOpenOptions* const options = TIFFOpenOptionsAlloc();
    if (!options)
        return nullptr;
    TIFFOpenOptionsSetErrorHandlerExtR(options, keep_complaint, &client);
    TIFFOpenOptionsSetWarningHandlerExtR(options, drop_warning, nullptr);
    // "4": classic TIFF, which raw converters read; byte order: the machine's.
    TIFF* const tif
        = TIFFClientOpenExt("DNG", "w4", &client, read_proc, write_proc, seek_proc,
                            close_proc, size_proc, nullptr, nullptr, options);
    TIFFOpenOptionsFree(options);
    return tif;
}

void close_tiff(tiff* tif)
{
    // Else libtiff would try again to write what it has, and does not bear every fault
    // there.
    constexpr int read_only = 0; // O_RDONLY of every system
    TIFFSetMode(tif, read_only);
    TIFFClose(tif);
}

bool set_tag(tiff* tif, const Tag& tag)
{
    return std::visit(Setter(tif, tag.number), tag.value);
}

} // namespace cg2raw

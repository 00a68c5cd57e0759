// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file Windows. Source: Win32's fileapi.h and winbase.h.
#include "platform/new_file.h"

#include "cg2raw/types.h"
#include "platform/paths.h"
#include "platform/temporary_name.h"

#include <algorithm>

#include <windows.h>

namespace cg2raw {

struct NewFile::State {
    std::string path; ///< as given, for messages
    std::wstring target; ///< whole, links resolved
    bool sync;
    std::wstring temporary {};
    HANDLE file = INVALID_HANDLE_VALUE;

    void open(bool replaces_links);
    void open_temporary();
    bool goes_with_process(bool goes) const;
    void discard() noexcept;
    [[noreturn]] void fail(const std::string& what,
                           DWORD error = ::GetLastError()) const;
};

namespace {

std::error_code system_error(DWORD error)
{
    return { int(error), std::system_category() };
}

/// A path from the root that Windows takes as it is, of any length.
std::wstring whole_path(const std::string& path)
{
    check_path(path);
    const std::wstring given = path_of(path).wstring();
    const DWORD size = ::GetFullPathNameW(given.c_str(), 0, nullptr, nullptr);
    std::wstring whole(size, L'\0');
    whole.resize(::GetFullPathNameW(given.c_str(), size, whole.data(), nullptr));
    if (whole.rfind(LR"(\\)", 0) != 0)
        return LR"(\\?\)" + whole;
    const bool is_special = whole.size() > 3 && (whole[2] == L'?' || whole[2] == L'.');
    return is_special ? whole : LR"(\\?\UNC\)" + whole.substr(2);
}

/// What a symbolic link at @p path leads to; empty if that is nothing.
std::wstring link_target(const std::wstring& path)
{
    const HANDLE file = ::CreateFileW(
        path.c_str(), 0, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
        nullptr, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, nullptr);
    if (file == INVALID_HANDLE_VALUE)
        return L"";
    std::wstring found(32768, L'\0'); // the longest path that Windows has
    found.resize(
        ::GetFinalPathNameByHandleW(file, found.data(), DWORD(found.size()), 0));
    ::CloseHandle(file);
    return found;
}

/// A hidden name beside @p target that no other writer has.
std::wstring temporary_name(const std::wstring& target)
{
    const std::string ending = temporary_ending(); // ASCII
    const std::size_t base = target.rfind(L'\\') + 1;
    // A name has 255 characters at most: the tail of a long one is dropped.
    return target.substr(0, base) + L"." + target.substr(base, 200)
        + std::wstring(ending.begin(), ending.end());
}

OVERLAPPED at(std::uint64_t offset)
{
    OVERLAPPED place {};
    place.Offset = DWORD(offset);
    place.OffsetHigh = DWORD(offset >> 32);
    return place;
}

/// As much as one call takes.
DWORD piece(std::size_t size) { return DWORD(std::min<std::size_t>(size, 1u << 30)); }

} // namespace

NewFile::NewFile(const std::string& path, bool sync, bool)
    : m_state(new State { path, whole_path(path), sync })
{
    m_state->open(false);
}

NewFile::NewFile(int, const std::string& name, const std::string& path, bool sync, bool)
    : m_state(new State { path, whole_path(name), sync })
{
    m_state->open(true);
}

NewFile::~NewFile() { m_state->discard(); }

std::error_code NewFile::write(const void* data, std::size_t size,
                               std::uint64_t offset) noexcept
{
    const char* from = static_cast<const char*>(data);
    while (size > 0) {
        OVERLAPPED place = at(offset);
        DWORD done = 0;
        if (!::WriteFile(m_state->file, from, piece(size), &done, &place))
            return system_error(::GetLastError());
        if (done == 0)
            return system_error(ERROR_DISK_FULL);
        from += done;
        size -= done;
        offset += done;
    }
    return {};
}

std::size_t NewFile::read(void* data, std::size_t size, std::uint64_t offset) noexcept
{
    std::size_t done = 0;
    while (done < size) {
        OVERLAPPED place = at(offset + done);
        DWORD got = 0;
        char* const to = static_cast<char*>(data) + done;
        if (!::ReadFile(m_state->file, to, piece(size - done), &got, &place)
            || got == 0)
            break;
        done += got;
    }
    return done;
}

/// Between the first two steps and the last, and only there, the complete file has a
/// temporary name that outlives the process.
void NewFile::publish()
{
    State& state = *m_state;
    if (state.sync && !::FlushFileBuffers(state.file))
        state.fail("write");
    if (!state.goes_with_process(false))
        state.fail("write");
    ::CloseHandle(state.file);
    state.file = INVALID_HANDLE_VALUE;
    const DWORD flags
        = MOVEFILE_REPLACE_EXISTING | (state.sync ? MOVEFILE_WRITE_THROUGH : 0);
    if (!::MoveFileExW(state.temporary.c_str(), state.target.c_str(), flags))
        state.fail("replace");
    state.temporary.clear();
}

void NewFile::State::open(bool replaces_links)
{
    DWORD found = ::GetFileAttributesW(target.c_str());
    const bool is_link
        = found != INVALID_FILE_ATTRIBUTES && (found & FILE_ATTRIBUTE_REPARSE_POINT);
    if (is_link && !replaces_links) {
        const std::wstring real = link_target(target);
        if (real.empty())
            fail("create");
        target = real;
        found = ::GetFileAttributesW(target.c_str());
    }
    const bool is_device = target.rfind(LR"(\\.\)", 0) == 0; // as NUL
    const bool is_there = found != INVALID_FILE_ATTRIBUTES;
    if (is_device || (is_there && (found & FILE_ATTRIBUTE_DIRECTORY)))
        throw Error(path + ": is not a regular file: choose another name");
    if (is_there && (found & FILE_ATTRIBUTE_READONLY))
        fail("replace", ERROR_ACCESS_DENIED);
    open_temporary();
}

void NewFile::State::open_temporary()
{
    std::wstring name;
    int tries = 0;
    do {
        name = temporary_name(target);
        file = ::CreateFileW(name.c_str(), GENERIC_READ | GENERIC_WRITE | DELETE,
                             FILE_SHARE_READ | FILE_SHARE_DELETE, nullptr, CREATE_NEW,
                             FILE_ATTRIBUTE_NORMAL, nullptr);
    } while (file == INVALID_HANDLE_VALUE && ::GetLastError() == ERROR_FILE_EXISTS
             && ++tries < most_temporary_names);
    if (file == INVALID_HANDLE_VALUE)
        fail("create");
    temporary = name;
    goes_with_process(true); // a share that cannot: discard() deletes it
}

/// Whether Windows deletes the file when the process ends, however it ends.
bool NewFile::State::goes_with_process(bool goes) const
{
    FILE_DISPOSITION_INFO info {};
    info.DeleteFile = goes;
    return ::SetFileInformationByHandle(file, FileDispositionInfo, &info, sizeof info)
        != 0;
}

void NewFile::State::discard() noexcept
{
    if (file != INVALID_HANDLE_VALUE)
        ::CloseHandle(file);
    if (!temporary.empty())
        ::DeleteFileW(temporary.c_str());
}

void NewFile::State::fail(const std::string& what, DWORD error) const
{
    throw Error(path + ": cannot " + what + ": " + words_of(system_error(error)));
}

/// Those of Linux, where the C++ library has a condition for the error.
std::string words_of(const std::error_code& error)
{
    return error.default_error_condition().message();
}

} // namespace cg2raw

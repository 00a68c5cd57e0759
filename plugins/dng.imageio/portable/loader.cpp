// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What OpenImageIO opens as the plugin where the plugin was not built for that
/// one libOpenImageIO.
///
/// Each release of OpenImageIO's wheel has a library of its own name
/// (libOpenImageIO.so.3.1.19), and a Python keeps the libraries of its modules to
/// themselves. So the plugin proper, which lies beside this file, names no such
/// library, and finds its symbols among the global ones only. This loader makes those
/// of the OpenImageIO that the process has loaded global (OpenImageIO does the same for
/// each plugin that names its library), and then opens the plugin. If that fails it
/// calls its plugin API 0: OpenImageIO passes over it and looks in the next folder.
#include <dlfcn.h>
#include <link.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#define CG2RAW_EXPORT extern "C" __attribute__((visibility("default")))

namespace {

namespace fs = std::filesystem;

constexpr const char* plugin_name = "libcg2raw_dng_imageio.so";
constexpr std::size_t most_extensions = 15;

using Extensions = std::array<const char*, most_extensions + 1>; // the last stays null

/// The plugin proper; null if it does not load.
void* plugin = nullptr;

/// What the plugin exports as @p name; null if it does not load.
void* symbol(const char* name) { return plugin ? dlsym(plugin, name) : nullptr; }

/// What the plugin's function @p name returns; null if there is no plugin.
void* result_of(const char* name)
{
    const auto function = reinterpret_cast<void* (*)()>(symbol(name));
    return function ? function() : nullptr;
}

/// Copy the plugin's null-terminated list @p name.
void fill(Extensions& list, const char* name)
{
    auto* from = static_cast<const char**>(symbol(name));
    for (std::size_t i = 0; from && from[i] && i < most_extensions; ++i)
        list[i] = from[i];
}

/// Paths of the libraries called libOpenImageIO that this process has loaded.
std::vector<std::string> loaded_openimageios()
{
    std::vector<std::string> paths;
    dl_iterate_phdr(
        [](dl_phdr_info* info, std::size_t, void* found) {
            const std::string path = info->dlpi_name ? info->dlpi_name : "";
            const std::string name = fs::path(path).filename().string();
            if (name.rfind("libOpenImageIO", 0) == 0
                && name.find("_Util") == std::string::npos)
                static_cast<std::vector<std::string>*>(found)->push_back(path);
            return 0;
        },
        &paths);
    return paths;
}

/// Open the plugin beside this file, if need be by an OpenImageIO made global.
void* open_plugin()
{
    Dl_info own {};
    if (!dladdr(reinterpret_cast<const void*>(&open_plugin), &own) || !own.dli_fname)
        return nullptr;
    const std::string path
        = (fs::path(own.dli_fname).parent_path() / plugin_name).string();
    constexpr int how = RTLD_NOW | RTLD_LOCAL;
    void* opened = dlopen(path.c_str(), how);
    for (const std::string& library :
         opened ? std::vector<std::string> {} : loaded_openimageios()) {
        if (dlopen(library.c_str(), RTLD_LAZY | RTLD_NOLOAD | RTLD_GLOBAL))
            opened = dlopen(path.c_str(), how);
        if (opened)
            break;
    }
    const char* wordy = std::getenv("OPENIMAGEIO_DEBUG");
    if (!opened && wordy && std::atoi(wordy) > 0)
        std::fprintf(stderr, "cg2raw: %s\n", dlerror());
    return opened;
}

} // namespace

CG2RAW_EXPORT int dng_imageio_version;
int dng_imageio_version = CG2RAW_OIIO_PLUGIN_API;

#define CG2RAW_LIST(name)                                                              \
    CG2RAW_EXPORT Extensions name;                                                     \
    Extensions name {};
#define CG2RAW_FUNCTION(name)                                                          \
    CG2RAW_EXPORT void* name();                                                        \
    void* name() { return result_of(#name); }
#include "loader_exports.inc"
#undef CG2RAW_LIST
#undef CG2RAW_FUNCTION

namespace {

/// Runs when OpenImageIO opens this file, before it asks for anything.
__attribute__((constructor)) void load()
{
    plugin = open_plugin();
    if (!plugin)
        dng_imageio_version = 0;
#define CG2RAW_LIST(name) fill(name, #name);
#define CG2RAW_FUNCTION(name)
#include "loader_exports.inc"
}

} // namespace

// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What is fuzzed: bytes of strangers through one reader each, and through all
/// that is done with what it accepts.
#pragma once

#include "cg2raw/profile.h"

#include <functional>
#include <stdexcept>
#include <string_view>

namespace cg2raw::test {

/// What no input may bring about.
struct Finding : std::logic_error {
    using std::logic_error::logic_error;
};

/// Memory that a reader may hold: so much whatever the file, and so many times its
/// size.
struct MemoryBound {
    std::size_t fixed, times_the_file;
};
constexpr MemoryBound dng_memory { 64 * 1024, 8 };
/// A bit may be a pixel, which takes two bytes as DN, and again in its tile, and four
/// as a signal.
constexpr MemoryBound mosaic_memory { 64 * 1024, 96 };
constexpr MemoryBound profile_memory { 64 * 1024, 128 };
constexpr MemoryBound spectra_memory { 64 * 1024, 64 };
/// An Error; the tables lie on the stack, and the samples are the caller's.
constexpr MemoryBound jpeg_memory { 16 * 1024, 0 };
/// The longest list of lights has 100000 words.
constexpr MemoryBound illuminant_memory { 16 << 20, 64 };

/// @p bytes as a DNG, to its profile. Throws Finding for an Error that does not name
/// the file, for memory beyond dng_memory, and as use() does. Returns false if the
/// reader refused it.
bool fuzz_dng_reader(std::string_view bytes);
/// @p bytes as a DNG, to its pixels and the picture that they develop to, likewise
/// within mosaic_memory; false also if its pixels are damaged.
bool fuzz_mosaic(std::string_view bytes);
/// @p bytes as a profile's JSON, likewise within profile_memory.
bool fuzz_profile(std::string_view bytes);
/// @p bytes as the channels of an image, a line each: a name and, after tabs, its
/// wavelength in m and its response as attributes say them; likewise within
/// spectra_memory. Returns false if they are no spectrum.
bool fuzz_spectra(std::string_view bytes);
/// @p bytes as a lossless JPEG, likewise within jpeg_memory, and again encoded and
/// decoded.
bool fuzz_jpeg(std::string_view bytes);
/// @p bytes as the word of a light, a list of them, and the name of a colour space,
/// likewise within illuminant_memory. Returns false if they are none of these.
bool fuzz_illuminant(std::string_view bytes);
/// @p bytes as what a host asks of the plugin, a line each (plugin_program.h says
/// which), in a folder for that alone. Throws Finding unless what is left there is a
/// whole DNG or nothing, for a descriptor that stays open, for a call that fails
/// without a message, and for a message that does not name the file. Returns false if
/// no file was published.
bool fuzz_plugin(std::string_view bytes);

/// Runs @p read, whose input has @p size bytes. Throws Finding if it held more memory
/// than @p bound allows, or threw an Error that does not start with @p name and a
/// colon, or is no message. Returns false if it threw an Error.
bool bounded(const std::function<void()>& read, std::size_t size, MemoryBound bound,
             const std::string& name);

/// Throws Finding unless @p message is one line of at most 2000 bytes.
void check_message(const std::string& message);

/// All that is computed of a light that @p spec names: it is finite, or refused.
void use_light(const SensorProfile& profile, const char* spec);

/// All that is computed of a profile before the first pixel: it is finite, or refused
/// by an Error. Throws Finding unless to_json() reads back the same.
void use(const SensorProfile& profile);

/// The largest share of its bound that any call of bounded() took, 0 to 1.
double most_of_bound();

} // namespace cg2raw::test

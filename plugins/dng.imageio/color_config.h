// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file What OpenColorIO's current config says of linear light. Loading one of many
/// spaces takes longer than a small export: it is done where nothing else tells.
#pragma once

#include <string>

namespace cg2raw {

/// Whether "linear" or "scene_linear" is Rec.709; without a config it is.
bool is_rec709_word(const std::string& word);

/// A space of the current config that is Rec.709, for the remedy of a message.
std::string rec709_space();

} // namespace cg2raw

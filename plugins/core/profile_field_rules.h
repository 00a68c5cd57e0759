// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

/// @file The rules that cg2raw/profile_fields.def names; private to the core.
#pragma once

#include "noise_table.h"
#include "profile_rules.h"

namespace cg2raw {

Rule<std::string> sensor_id();
Rule<TextsByField> source_texts();
Rule<CfaPattern> cfa_name();
/// @p with_other : also "other", which has no temperature.
Rule<int> light_name(bool with_other = false);
/// One or two, in fields of their own; see profile_json.cpp.
struct ColorMatrices { };
Rule<std::vector<Lamp>> lamp_list();
Rule<SpectralSensitivities> sensitivities(const CfaPattern& cfa);
Rule<NeutralDistribution> neutral_distribution();
Rule<DigitalGain> gain_distribution();
Rule<std::vector<NoiseAtIso>> noise_table(const CfaPattern& cfa);
Rule<NoiseEffects> noise_effect_names();
/// Their parameters are checked when they are simulated.
Rule<std::vector<EffectSetting>> effect_settings();

/// CFAs as a pattern of JSON Schema, which knows no case, and how many numbers may
/// stand for their sites.
struct CfaPatterns {
    std::string pattern;
    std::vector<int> counts;
};
std::vector<CfaPatterns> cfa_patterns();
const std::string& mono_pattern();

} // namespace cg2raw

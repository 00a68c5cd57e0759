// SPDX-License-Identifier: Apache-2.0
// Copyright Contributors to the cg2raw Project.

#include "cg2raw/exposure.h"

#include "cg2raw/random.h"
#include "elementary.h"
#include "text.h"

#include <algorithm>
#include <cmath>

namespace cg2raw {
namespace {

/// H = q L t / N^2, for a transmittance of 0.9, vignetting of 0.98 and an angle of 10
/// degrees; saturation at H = 78 / S lx s. Source: ISO 12232:2019.
constexpr double q = 0.65, saturation = 78.0;
/// What a camera's program chooses from, where no limits are given.
constexpr Limits usual_times { 1.0 / 8000.0, 30.0 }, usual_f_numbers { 1.0, 32.0 };

double power_of_two(double stops)
{
    const double whole = std::nearbyint(stops);
    constexpr double ln_2 = 0.69314718055994530942;
    return std::ldexp(exponential((stops - whole) * ln_2), int(whole));
}

double stops_of(double gain) { return natural_log(gain) / natural_log(2.0); }

double at_probability(const Quantiles& quantiles, double p)
{
    const auto above = std::find_if(quantiles.begin() + 1, quantiles.end() - 1,
                                    [&](const auto& one) { return one[0] >= p; });
    const auto& [low, from] = *(above - 1);
    const auto& [high, to] = *above;
    return from + (to - from) * (p - low) / (high - low);
}

/// The share of levels, by their quantiles, that lie below @p level.
double share_below(const Quantiles& quantiles, double level)
{
    const auto above = std::find_if(quantiles.begin(), quantiles.end(),
                                    [&](const auto& one) { return one[1] > level; });
    if (above == quantiles.begin() || above == quantiles.end())
        return above == quantiles.begin() ? 0.0 : 1.0;
    const auto& [low, from] = *(above - 1);
    const auto& [high, to] = *above;
    return low + (high - low) * (level - from) / (to - from);
}

/// The rank of @p level among others, 0 to 1. All are known within a tenth of a stop:
/// of those that are nearer, half lie below.
double rank_among(const Quantiles& quantiles, double level)
{
    constexpr double near = 0.1;
    return 0.5
        * (share_below(quantiles, level - near) + share_below(quantiles, level + near));
}

/// The stops of a rule by which a meter has read @p luminance, above 0.
double metered_stops(const ExposureRule& rule, double luminance)
{
    if (rule.kind == ExposureRule::Kind::meter)
        return stops_of(rule.second / luminance);
    const double level = stops_of(luminance);
    return at_probability(rule.quantiles, rank_among(rule.renders, level)) - level;
}

/// The stops of a rule that needs no meter.
double drawn(const ExposureRule& rule, const Run& run)
{
    using Kind = ExposureRule::Kind;
    const Rng rng(run.seed, "exposure", run.frame);
    switch (rule.kind) {
    case Kind::uniform:
        return rule.first + (rule.second - rule.first) * rng.uniform(0);
    case Kind::normal:
        return rule.first + rule.second * rng.normal(0);
    case Kind::drawn_match:
        return at_probability(rule.quantiles, rng.uniform(0));
    default:
        return rule.first;
    }
}

/// The settings of a camera, and the gain that they are.
class Settings {
public:
    Settings(const SensorProfile& profile, const Run& run, const SettingName& name)
        : m_profile(profile)
        , m_run(run)
        , m_name(name)
    {
        m_result.exposure_time = run.exposure_time;
        m_result.f_number = run.f_number;
        m_result.iso = run.iso;
        positive(run.f_number, "f_number", 1e6);
        positive(run.scene_luminance, "scene_luminance", 1e12);
        if (!(std::abs(run.nd_filter) <= 64.0))
            throw Error(name("nd_filter", "") + " " + number(run.nd_filter)
                        + " must be -64 to 64");
    }

    SettledExposure settled()
    {
        decide_stops();
        if (m_run.scene_luminance)
            follow_light();
        else
            refuse_without_light();
        m_result.gain_stops += m_result.stops.value_or(0.0);
        if (m_run.bracket)
            bracket();
        m_result.gain = power_of_two(m_result.gain_stops + m_run.bracket.value_or(0.0));
        return m_result;
    }

private:
    void positive(const std::optional<double>& value, const char* setting,
                  double most) const
    {
        if (value && !(*value > 0.0 && *value <= most))
            throw Error(m_name(setting, "") + " " + number(*value)
                        + " must be above 0, up to " + number(most));
    }

    bool is_metered() const { return needs_meter(m_run); }
    std::string asked() const { return m_name("exposure", m_run.exposure->text); }

    void decide_stops()
    {
        if (!m_run.exposure)
            return;
        const ExposureRule& rule = *m_run.exposure;
        if (!rule.sensor.empty() && !m_profile.id.empty()
            && rule.sensor != m_profile.id)
            throw Error(m_name("exposure", rule.text) + " is of captures by sensor "
                        + rule.sensor + ", and this one is " + m_profile.id
                        + ": run cg2raw match --sensor " + m_profile.id);
        if (!is_metered()) {
            m_result.stops = drawn(rule, m_run);
            return;
        }
        if (!m_run.meter)
            throw Error(asked()
                        + " needs the whole image before its first pixel, and there is "
                          "none: give stops");
        // A black scene has no exposure, and nothing to be seen.
        m_result.stops = *m_run.meter > 0.0 ? metered_stops(rule, *m_run.meter) : 0.0;
    }

    /// The gain of all settings that are there; 1 in the place of one that is not.
    double gain_of_settings() const
    {
        const double iso = m_result.iso
            ? std::max(*m_result.iso, m_profile.base_iso.value_or(0.0))
            : 1.0;
        const double aperture = m_result.f_number.value_or(1.0);
        return q * *m_run.scene_luminance * power_of_two(-m_run.nd_filter)
            * m_result.exposure_time.value_or(1.0) / (aperture * aperture) * iso
            / saturation;
    }

    void follow_light()
    {
        std::vector<std::pair<const char*, const char*>> missing;
        if (!m_result.exposure_time)
            missing.emplace_back("exposure_time", "1/60");
        if (!m_result.f_number)
            missing.emplace_back("f_number", "2.8");
        if (!m_result.iso)
            missing.emplace_back("iso", "100");
        if (is_metered()) {
            find(missing);
        } else if (!missing.empty()) {
            const auto [setting, example] = missing.front();
            throw Error(m_name("scene_luminance", "") + " is given without "
                        + m_name(setting, "") + ": add " + m_name(setting, example)
                        + ", or " + m_name("exposure", "auto")
                        + " to find one setting");
        }
        m_result.gain_stops = stops_of(gain_of_settings());
    }

    /// The one setting by which the meter's luminance gets the level that is wanted.
    void find(const std::vector<std::pair<const char*, const char*>>& missing)
    {
        const std::string three = m_name("exposure_time", "") + ", "
            + m_name("f_number", "") + " and " + m_name("iso", "");
        if (missing.empty())
            throw Error(asked() + " has nothing to find: leave one of " + three
                        + " out, or " + m_name("scene_luminance", ""));
        if (missing.size() > 1)
            throw Error(asked() + " with " + m_name("scene_luminance", "")
                        + " finds one setting: add "
                        + m_name(missing[0].first, missing[0].second) + " or "
                        + m_name(missing[1].first, missing[1].second));
        const double wanted = power_of_two(*m_result.stops);
        const std::string setting = missing.front().first;
        if (setting == "exposure_time")
            m_result.exposure_time
                = within(wanted / gain_of_settings(), m_run.time_limits, usual_times);
        else if (setting == "f_number")
            m_result.f_number = within(std::sqrt(gain_of_settings() / wanted),
                                       m_run.f_number_limits, usual_f_numbers);
        else
            m_result.iso = std::nearbyint(
                within(wanted / gain_of_settings(), m_run.iso_limits, usual_isos()));
        m_result.stops.reset(); // the settings are all of it
    }

    static double within(double value, const std::optional<Limits>& given,
                         const Limits& usual)
    {
        const Limits limits = given.value_or(usual);
        return std::clamp(value, limits.low, limits.high);
    }

    Limits usual_isos() const
    {
        const auto& table = m_profile.noise;
        if (table.empty())
            return { m_profile.base_iso.value_or(100.0), 1e7 };
        return { table.front().iso, table.back().iso };
    }

    void refuse_without_light() const
    {
        const auto refuse = [&](bool is_given, const char* setting) {
            if (is_given)
                throw Error(m_name(setting, "") + " is given without "
                            + m_name("scene_luminance", "") + ": add "
                            + m_name("scene_luminance", "100") + ", or leave it out");
        };
        refuse(m_run.nd_filter != 0.0, "nd_filter");
        refuse(m_run.iso_limits.has_value(), "iso_limits");
        refuse(m_run.time_limits.has_value(), "time_limits");
        refuse(m_run.f_number_limits.has_value(), "f_number_limits");
    }

    void bracket()
    {
        if (!(std::abs(*m_run.bracket) <= 64.0))
            throw Error(m_name("bracket", "") + " " + number(*m_run.bracket)
                        + " must be -64 to 64 stops");
        if (!m_result.exposure_time)
            throw Error(m_name("bracket", "")
                        + " changes the exposure time, which is not known: add "
                        + m_name("exposure_time", "1/60"));
        *m_result.exposure_time *= power_of_two(*m_run.bracket);
    }

    const SensorProfile& m_profile;
    const Run& m_run;
    const SettingName& m_name;
    SettledExposure m_result;
};

} // namespace

SettledExposure settle(const SensorProfile& profile, const Run& run,
                       const SettingName& name)
{
    return Settings(profile, run, name).settled();
}

SettledExposure settle(const SensorProfile& profile, const Run& run)
{
    return settle(profile, run, [](std::string_view name, std::string_view value) {
        return std::string(name) + (value.empty() ? "" : "=" + std::string(value));
    });
}

bool needs_meter(const Run& run)
{
    using Kind = ExposureRule::Kind;
    return run.exposure
        && (run.exposure->kind == Kind::meter || run.exposure->kind == Kind::matched);
}

} // namespace cg2raw

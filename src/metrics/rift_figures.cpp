// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <iterator>

#include "metrics/figure_rows.h"

namespace cdiff::metrics {
namespace {

constexpr auto kHigher = Direction::kHigherIsBetter;
constexpr auto kLower = Direction::kLowerIsBetter;
constexpr auto kNeither = Direction::kNeither;

/// Row of a key of rift_compat.
#define RIFT_FIGURE(key, label, unit, direction, definition)                                   \
  {                                                                                            \
    "rift_compat_" key, "/metrics/rift_compat/" key "/value", "RIFT: " label, unit, direction, \
        definition, "", [](const M& m) { return riftMeasure(m, key); }                         \
  }

Measure riftMeasure(const M& measures, const char* key) {
  const auto found = measures.rift_compat.find(key);
  if (found != measures.rift_compat.end()) return found->second;
  Measure absent;
  absent.reason = "not computed";
  return absent;
}

constexpr FigureDefinition kRows[] = {
    RIFT_FIGURE("acceleration_mean_mps2", "acceleration, mean", "m/s^2", kNeither,
                "Mean of the magnitude of acceleration from the midpoints of RIFT's bins below 3 "
                "m/s^2, histories repeated."),
    RIFT_FIGURE("acceleration_shapiro_wilk", "A-SW", "", kHigher,
                "Shapiro-Wilk W of 3000 values drawn from that histogram."),
    RIFT_FIGURE("acceleration_std_mps2", "acceleration, standard deviation", "m/s^2", kNeither,
                "Square root of the variance of that histogram's midpoints."),
    RIFT_FIGURE("act_s", "ACT, mean", "s", kHigher,
                "Per decision the smallest over vehicles within 60 m of shortest corner-to-corner "
                "distance / approach speed of the centres, rounded to 0.01 s; mean of 0.5 s bins "
                "below 5 s at ego speeds of 3 to 10 m/s."),
    RIFT_FIGURE("act_variance_s2", "ACT, variance", "s^2", kNeither,
                "Variance of the same bins' midpoints."),
    RIFT_FIGURE("collisions_per_km", "CPK", "1/km", kNeither,
                "1000 x CBVs that collided / distance over decision ticks in metres."),
    RIFT_FIGURE(
        "jerk_mean_mps3", "jerk, mean", "m/s^3", kNeither,
        "Mean of (magnitude of acceleration - the last one) / decision period, the first last "
        "one being 0, from 2 m/s^3 bins from -10 to 10, histories repeated."),
    RIFT_FIGURE("jerk_std_mps3", "jerk, standard deviation", "m/s^3", kLower,
                "Square root of the variance of that jerk histogram's midpoints."),
    RIFT_FIGURE("off_road_rate_percent", "ORR", "%", kLower,
                "100 x CBV decisions with the centre off the drivable area / CBV decisions."),
    RIFT_FIGURE(
        "reached_progress_m", "RP", "m", kHigher,
        "Sum over CBVs of the distance between successive decisions; a sum, so it grows with "
        "the time driven as CBV."),
    RIFT_FIGURE("speed_mean_mps", "speed, mean", "m/s", kNeither,
                "Mean speed from the midpoints of RIFT's bins below 14 m/s, histories repeated."),
    RIFT_FIGURE("speed_shapiro_wilk", "S-SW", "", kHigher,
                "Shapiro-Wilk W of 3000 values drawn from RIFT's histogram of speeds."),
    RIFT_FIGURE("speed_std_mps", "speed, standard deviation", "m/s", kNeither,
                "Square root of the variance of RIFT's histogram of speeds."),
    RIFT_FIGURE("speed_wasserstein_mps", "S-WD", "m/s", kLower,
                "sqrt((mean - 8.5)^2 + deviation^2) of RIFT's histogram of speeds."),
    RIFT_FIGURE(
        "ttc_2d_s", "RTTC, mean", "s", kHigher,
        "Per decision the smallest over vehicles within 60 m of RIFT's ray cast with bow-tie "
        "outlines, rounded to 0.01 s; mean of 0.5 s bins below 5 s at ego speeds of 3 to 10 "
        "m/s."),
    RIFT_FIGURE("ttc_2d_variance_s2", "RTTC, variance", "s^2", kNeither,
                "Variance of the RTTC bins' midpoints; RIFT prints it after +-."),
    RIFT_FIGURE("uncomfortable_rate_percent", "UC", "%", kLower,
                "As cbv_uncomfortable_percent with a first last acceleration of 0."),
};
#undef RIFT_FIGURE

}  // namespace

FigureRows riftFigures() { return {std::begin(kRows), std::end(kRows)}; }

}  // namespace cdiff::metrics

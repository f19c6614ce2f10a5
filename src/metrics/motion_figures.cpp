// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <iterator>

#include "metrics/figure_rows.h"

namespace cdiff::metrics {
namespace {

constexpr auto kHigher = Direction::kHigherIsBetter;
constexpr auto kLower = Direction::kLowerIsBetter;
constexpr auto kNeither = Direction::kNeither;

constexpr const char* kRepeats =
    "RIFT adds the whole history of each living CBV again at every tick (sample i of an n-tick "
    "life "
    "counts n - i times) and takes mean and deviation from the midpoints of its bins.";
constexpr const char* kResamples =
    "RIFT draws 3000 values (NumPy's stream of seed 0) from a histogram in which early samples are "
    "counted again at every tick.";

constexpr FigureDefinition kRows[] = {
    {"cbv_speed_mean_mps", "/metrics/speed_mps/mean", "Speed of CBVs, mean", "m/s", kNeither,
     "Mean speed of CBVs over CBV decisions.", kRepeats,
     [](const M& m) { return m.cbv_speed.mean; }},
    {"cbv_speed_std_mps", "/metrics/speed_mps/std", "Speed of CBVs, standard deviation", "m/s",
     kNeither, "Standard deviation (n - 1) of the speed of CBVs over CBV decisions.", kRepeats,
     [](const M& m) { return m.cbv_speed.standard_deviation; }},
    {"cbv_speed_min_mps", "/metrics/speed_mps/min", "Speed of CBVs, minimum", "m/s", kNeither,
     "Smallest speed of a CBV at a CBV decision.", "",
     [](const M& m) { return m.cbv_speed.minimum; }},
    {"cbv_acceleration_mean_mps2", "/metrics/acceleration_mps2/mean",
     "Acceleration of CBVs, mean magnitude", "m/s^2", kNeither,
     "Mean over CBV decisions of the magnitude of acceleration, sqrt(longitudinal^2 + lateral^2); "
     "longitudinal = change of speed over the last simulation step / step, lateral = speed x yaw "
     "rate.",
     kRepeats, [](const M& m) { return m.cbv_acceleration.mean; }},
    {"cbv_acceleration_std_mps2", "/metrics/acceleration_mps2/std",
     "Acceleration of CBVs, standard deviation of the magnitude", "m/s^2", kNeither,
     "Standard deviation (n - 1) of the same magnitudes.", kRepeats,
     [](const M& m) { return m.cbv_acceleration.standard_deviation; }},
    {"cbv_acceleration_min_mps2", "/metrics/acceleration_mps2/min",
     "Acceleration of CBVs, smallest magnitude", "m/s^2", kNeither,
     "The smallest of the same magnitudes.", "",
     [](const M& m) { return m.cbv_acceleration.minimum; }},
    {"cbv_jerk_mean_mps3", "/metrics/jerk_mps3/mean", "Jerk of CBVs, mean", "m/s^3", kNeither,
     "Mean of the jerk of CBVs: change of the magnitude of acceleration from one CBV decision to "
     "the "
     "next / decision period, signed; a vehicle's first decision as CBV has none.",
     "RIFT takes the acceleration before the first decision as 0 and adds histories again at every "
     "tick (bins from -10 to 10 m/s^3).",
     [](const M& m) { return m.cbv_jerk.mean; }},
    {"cbv_jerk_std_mps3", "/metrics/jerk_mps3/std", "Jerk of CBVs, standard deviation", "m/s^3",
     kLower, "Standard deviation (n - 1) of the same jerks.",
     "RIFT takes it from the midpoints of its bins, with the same additions as for the mean.",
     [](const M& m) { return m.cbv_jerk.standard_deviation; }},
    {"cbv_jerk_min_mps3", "/metrics/jerk_mps3/min", "Jerk of CBVs, smallest", "m/s^3", kNeither,
     "The smallest (most negative) of the same jerks.", "",
     [](const M& m) { return m.cbv_jerk.minimum; }},
    {"speed_shapiro_wilk", "/metrics/speed_shapiro_wilk/value", "Shapiro-Wilk W of CBV speeds", "",
     kHigher,
     "Shapiro-Wilk W (Royston 1995, AS R94) of the speeds of CBVs at CBV decisions; of more than "
     "5000 samples every k-th is taken (paper's S-SW).",
     kResamples, [](const M& m) { return m.speed_shapiro_wilk; }},
    {"speed_shapiro_wilk_p", "/metrics/speed_shapiro_wilk_p/value", "Shapiro-Wilk p of CBV speeds",
     "", kNeither,
     "Probability of a W as small as speed_shapiro_wilk for a normal sample of the same size "
     "(Royston 1995); neighbouring samples of one drive are not independent, so that it is no test "
     "at that level.",
     "RIFT reports W alone.", [](const M& m) { return m.speed_shapiro_wilk_p; }},
    {"acceleration_shapiro_wilk", "/metrics/acceleration_shapiro_wilk/value",
     "Shapiro-Wilk W of CBV accelerations", "", kHigher,
     "Shapiro-Wilk W of the signed longitudinal accelerations of CBVs at CBV decisions; samples as "
     "for speed_shapiro_wilk (paper's A-SW).",
     "RIFT takes the magnitude of the two-dimensional acceleration below 3 m/s^2, which is never "
     "negative, and draws 3000 values from its histogram.",
     [](const M& m) { return m.acceleration_shapiro_wilk; }},
    {"acceleration_shapiro_wilk_p", "/metrics/acceleration_shapiro_wilk_p/value",
     "Shapiro-Wilk p of CBV accelerations", "", kNeither,
     "Probability of a W as small as acceleration_shapiro_wilk for a normal sample of the same "
     "size.",
     "RIFT reports W alone.", [](const M& m) { return m.acceleration_shapiro_wilk_p; }},
    {"speed_wasserstein_mps", "/metrics/speed_wasserstein_mps/value",
     "Wasserstein distance of CBV speeds to the target", "m/s", kLower,
     "1-Wasserstein distance between the speeds of CBVs at CBV decisions and the target that is "
     "named "
     "beside it: speeds of background vehicles within 150 m of the ego at decisions of the same "
     "session (default), a normal distribution (exact integral), or the samples of a file (paper's "
     "S-WD).",
     "RIFT computes the 2-Wasserstein distance of two normal distributions, sqrt((mean - 8.5)^2 + "
     "deviation^2), from its histogram; 8.5 m/s stands for CARLA's default limit of 30 km/h.",
     [](const M& m) { return m.speed_wasserstein; }},
};

}  // namespace

FigureRows motionFigures() { return {std::begin(kRows), std::end(kRows)}; }

}  // namespace cdiff::metrics

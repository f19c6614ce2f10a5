// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <iterator>

#include "metrics/figure_rows.h"

namespace cdiff::metrics {
namespace {

constexpr auto kHigher = Direction::kHigherIsBetter;
constexpr auto kNeither = Direction::kNeither;

constexpr FigureDefinition kRows[] = {
    {"ttc_mean_s", "/metrics/ttc_2d_s/mean", "2D-TTC, mean", "s", kHigher,
     "Mean over decision ticks of the ego's smallest 2D time to collision: the first time at which "
     "its oriented box and that of any vehicle within 60 m on its level touch, both keeping "
     "velocity "
     "and heading; decisions without a contact ahead within 3600 s are left out (paper's 2D-TTC).",
     "RIFT casts rays from corners onto bow-tie outlines, keeps times below 5 s at ego speeds of 3 "
     "to 10 m/s, and averages the midpoints of 0.5 s bins.",
     [](const M& m) { return m.ttc_2d.mean; }},
    {"ttc_std_s", "/metrics/ttc_2d_s/std", "2D-TTC, standard deviation", "s", kNeither,
     "Standard deviation (n - 1) of the same values.",
     "RIFT prints the variance of its bins as if it were the deviation.",
     [](const M& m) { return m.ttc_2d.standard_deviation; }},
    {"ttc_min_s", "/metrics/ttc_2d_s/min", "2D-TTC, minimum", "s", kHigher,
     "The smallest of the same values; 0 for overlapping boxes.", "RIFT gives no minimum.",
     [](const M& m) { return m.ttc_2d.minimum; }},
    {"ttc_defined_percent", "/metrics/ttc_2d_defined_percent/value", "2D-TTC is defined", "%",
     kNeither, "Share of decision ticks with an ego at which its 2D time to collision is defined.",
     "", [](const M& m) { return m.ttc_2d_defined_percent; }},
    {"ttc_cbv_mean_s", "/metrics/ttc_2d_cbv_s/mean", "2D-TTC to CBVs, mean", "s", kHigher,
     "As ttc_mean_s, of the CBVs alone.", "RIFT takes all vehicles.",
     [](const M& m) { return m.ttc_2d_cbv.mean; }},
    {"ttc_cbv_std_s", "/metrics/ttc_2d_cbv_s/std", "2D-TTC to CBVs, standard deviation", "s",
     kNeither, "As ttc_std_s, of the CBVs alone.", "",
     [](const M& m) { return m.ttc_2d_cbv.standard_deviation; }},
    {"ttc_cbv_min_s", "/metrics/ttc_2d_cbv_s/min", "2D-TTC to CBVs, minimum", "s", kHigher,
     "As ttc_min_s, of the CBVs alone.", "", [](const M& m) { return m.ttc_2d_cbv.minimum; }},
    {"ttc_cbv_defined_percent", "/metrics/ttc_2d_cbv_defined_percent/value",
     "2D-TTC to CBVs is defined", "%", kNeither,
     "Share of decision ticks with an ego and a CBV at which the 2D time to collision to a CBV is "
     "defined.",
     "", [](const M& m) { return m.ttc_2d_cbv_defined_percent; }},
    {"ttc_lon_lat_mean_s", "/metrics/ttc_lon_lat_s/mean",
     "Smaller of longitudinal and lateral TTC, mean", "s", kHigher,
     "Mean over decision ticks of the ego's smallest time to collision by the paper's wording: in "
     "the ego's frame the smaller of gap / closing speed along and across, boxes taken as "
     "parallel, "
     "each valid where the other direction overlaps at that time; vehicles as for ttc_mean_s.",
     "RIFT does not report it.", [](const M& m) { return m.ttc_lon_lat.mean; }},
    {"ttc_lon_lat_std_s", "/metrics/ttc_lon_lat_s/std",
     "Smaller of longitudinal and lateral TTC, standard deviation", "s", kNeither,
     "Standard deviation (n - 1) of the values behind ttc_lon_lat_mean_s.", "",
     [](const M& m) { return m.ttc_lon_lat.standard_deviation; }},
    {"ttc_lon_lat_min_s", "/metrics/ttc_lon_lat_s/min",
     "Smaller of longitudinal and lateral TTC, minimum", "s", kHigher,
     "The smallest of the values behind ttc_lon_lat_mean_s.", "",
     [](const M& m) { return m.ttc_lon_lat.minimum; }},
    {"ttc_lon_lat_defined_percent", "/metrics/ttc_lon_lat_defined_percent/value",
     "Longitudinal or lateral TTC is defined", "%", kNeither,
     "Share of decision ticks with an ego at which the time behind ttc_lon_lat_mean_s is defined.",
     "", [](const M& m) { return m.ttc_lon_lat_defined_percent; }},
    {"post_encroachment_mean_s", "/metrics/post_encroachment_s/mean",
     "Post-encroachment time, mean over CBVs", "s", kHigher,
     "Mean over CBVs of the post-encroachment time with the ego: the time between the first one's "
     "box leaving and the second one's box entering a place, the shortest over all places that "
     "both "
     "boxes sweep; 0 for a contact, the net time gap for one behind the other, absent above 10 s "
     "(as "
     "in FHWA's SSAM, Gettman et al. 2008).",
     "RIFT does not compute it.", [](const M& m) { return m.post_encroachment.mean; }},
    {"post_encroachment_std_s", "/metrics/post_encroachment_s/std",
     "Post-encroachment time, standard deviation over CBVs", "s", kNeither,
     "Standard deviation (n - 1) of the post-encroachment times of the CBVs.", "",
     [](const M& m) { return m.post_encroachment.standard_deviation; }},
    {"post_encroachment_min_s", "/metrics/post_encroachment_s/min",
     "Post-encroachment time, minimum", "s", kHigher,
     "The smallest post-encroachment time of the CBVs.", "",
     [](const M& m) { return m.post_encroachment.minimum; }},
};

}  // namespace

FigureRows interactionFigures() { return {std::begin(kRows), std::end(kRows)}; }

}  // namespace cdiff::metrics

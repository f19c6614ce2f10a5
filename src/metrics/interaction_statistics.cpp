// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/interaction_statistics.h"

#include "metrics/cbv_measures.h"

namespace cdiff::metrics {

void InteractionStatistics::observe(const Interaction& interaction, bool cbv_driven) {
  if (interaction.ttc_2d) all_.add(*interaction.ttc_2d);
  if (interaction.ttc_2d_cbv) cbvs_.add(*interaction.ttc_2d_cbv);
  if (interaction.ttc_lon_lat) lon_lat_.add(*interaction.ttc_lon_lat);
  all_defined_.add(interaction.ttc_2d.has_value());
  lon_lat_defined_.add(interaction.ttc_lon_lat.has_value());
  if (cbv_driven) cbvs_defined_.add(interaction.ttc_2d_cbv.has_value());
}

void InteractionStatistics::write(SessionMeasures& measures) const {
  constexpr const char* kNoCourse = "no vehicle was on a collision course with the ego";
  constexpr const char* kNoEgo = "the ego was never seen";
  const bool no_cbv = cbvs_defined_.ticks() == 0;
  measures.ttc_2d = all_.measure("s", kNoCourse);
  measures.ttc_2d_cbv =
      cbvs_.measure("s", no_cbv ? kNoCbv : "no CBV was on a collision course with the ego");
  measures.ttc_lon_lat = lon_lat_.measure("s", kNoCourse);
  measures.ttc_2d_defined_percent = all_defined_.measure(kNoEgo);
  measures.ttc_2d_cbv_defined_percent = cbvs_defined_.measure(kNoCbv);
  measures.ttc_lon_lat_defined_percent = lon_lat_defined_.measure(kNoEgo);
}

}  // namespace cdiff::metrics

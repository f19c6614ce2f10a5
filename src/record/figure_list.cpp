// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/figure_list.h"

#include "metrics/metric_registry.h"

namespace cdiff::record {

std::string figureList() {
  std::string list;
  for (const metrics::FigureDefinition& figure : metrics::figureDefinitions()) {
    const std::string unit = *figure.unit ? figure.unit : "without unit";
    list += "### `" + std::string(figure.name) + "`\n\n" + figure.label + "; " + unit + "; " +
            metrics::toText(figure.subject) + "; " + metrics::toText(figure.direction) + "; `" +
            figure.place + "`\n\n" + figure.definition + "\n\n";
    if (*figure.rift_compat) list += "rift_compat: " + std::string(figure.rift_compat) + "\n\n";
  }
  return list;
}

}  // namespace cdiff::record

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The figures of a session by name, each with its unit, count and, where it cannot be given, the
/// reason; and the lists and contacts that belong to them.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "e2e_cdiff/metrics/metric.h"

namespace cdiff::metrics {

class SessionMeasures {
 public:
  /// The measure of a figure; one without value, "not computed", where no metric reported it.
  Measure at(const FigureDefinition& figure) const;
  /// Likewise by name. Throws core::InputError for a name that no metric has.
  Measure at(const std::string& name) const;
  /// The value of a figure that has one in every session; else 0.
  double number(const FigureDefinition& figure) const { return at(figure).value.value_or(0.0); }
  std::size_t count(const FigureDefinition& figure) const {
    return static_cast<std::size_t>(number(figure));
  }
  /// Sets a figure; its unit is the definition's.
  void set(const FigureDefinition& figure, Measure measure);

  std::string protocol;  ///< preset whose rules the score and the infractions follow
  std::vector<EgoContact> ego_contacts;                   ///< in order of time
  std::map<std::string, std::vector<MetricEntry>> lists;  ///< of summary.json, by JSON pointer

 private:
  std::map<std::string, Measure> measures_;  ///< by the figure's name
};

}  // namespace cdiff::metrics

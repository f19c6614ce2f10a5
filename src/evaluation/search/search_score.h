// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <vector>

#include "evaluation/run_record.h"

namespace cdiff::evaluation {

/// How bad a session was for its ego; higher is worse. With a contact of the moving ego it is
/// 1 + v / (v + 10 m/s), v the speed of the faster vehicle, and 1 more where the ego is at fault.
/// Without one it is below 1: the mean of 1 / (1 + smallest 2D-TTC / 1 s) and
/// 1 / (1 + smallest distance to a CBV between centers / 5 m), where one that is absent counts 0.
/// A session that did not end by its own rules has 0.
struct SearchScore {
  double value = 0.0;
  std::optional<RunContact> contact;  ///< the one that counts, of the moving ego

  /// Whether the moving ego had a contact.
  bool isFound() const { return value >= 1.0; }
};

/// `contacts` are those of the session's summary.
SearchScore searchScoreOf(const RunRecord& record, const std::vector<RunContact>& contacts);

}  // namespace cdiff::evaluation

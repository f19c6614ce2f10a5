// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Judges a session by its scenario's rules. A session that ended with error or interrupted is
/// never passed, and its rules are not judged.
#pragma once

#include <string>
#include <vector>

#include "e2e_cdiff/metrics/session_measures.h"
#include "e2e_cdiff/scenario/scenario_options.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::report {

/// What the verdict says.
struct Verdict {
  bool passed = false;
  std::vector<std::string> failures;  ///< one sentence per rule that was not met
};

enum class CheckOutcome { kPassed, kFailed, kError, kSkipped };

/// "passed", "failed", "error" or "skipped".
const char* toText(CheckOutcome outcome);

/// One rule, or the session itself (name "session").
struct Check {
  std::string name;
  CheckOutcome outcome = CheckOutcome::kPassed;
  std::string text;  ///< what was found and what was asked
};

/// Whether the session ended by its own rules, so that it can be judged.
bool endedByItself(traffic::SessionStatus status);

/// The session first, then every rule in a fixed order.
std::vector<Check> evaluateChecks(const scenario::VerdictOptions& rules,
                                  traffic::SessionStatus status,
                                  const metrics::SessionMeasures& measures,
                                  const std::vector<traffic::Fault>& faults);

/// Passed when no check failed; the texts of those that did.
Verdict verdictOf(const std::vector<Check>& checks);

}  // namespace cdiff::report

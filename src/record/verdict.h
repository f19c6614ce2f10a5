// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "metrics/session_metrics.h"
#include "record/outcome.h"
#include "session/scenario_options.h"
#include "session/steering.h"

namespace cdiff::record {

// Whether a session passed, by the rules of its scenario.

/// One rule of the scenario, or the session itself (name "session").
struct Check {
  std::string name;
  CheckOutcome outcome = CheckOutcome::kPassed;
  std::string text;  ///< what was found and what was asked
};

/// Judges a session by its scenario's rules. `judge` is the one place that decides: report, video,
/// summary, JUnit, tables, batches and exit codes read what it found.
struct Verdict {
  Outcome outcome = Outcome::kError;
  /// A sentence for each check that decided; empty when passed. Of a session that is not judged:
  /// why not, and its contacts.
  std::vector<std::string> reasons;
  std::vector<Check> checks;  ///< the session first, then each rule that the scenario sets
  std::vector<std::string> decided_by;  ///< names of the checks that decided
};

/// Whether the session ended by its own rules, so that it can be judged.
bool endedByItself(traffic::SessionStatus status);

/// Applies the rules of `options.verdict` in the session's mode. A session that broke or was
/// interrupted is not judged by them, nor is one that was steered by hand. Steering of the scenario
/// itself is part of what is judged, by the fiercest mode that it ever sets.
Verdict judge(const session::ScenarioOptions& options, traffic::SessionStatus status,
              const metrics::SessionMeasures& measures, const std::vector<traffic::Fault>& faults,
              const std::vector<session::SteeringRecord>& steering = {});

/// The ego's part in a contact, as the verdict counts it.
enum class Blame {
  kNone,     ///< the other struck the ego
  kExcused,  ///< the ego's fault, but no braking would have avoided it, and the rules excuse that
  kFault     ///< the ego's fault
};
Blame blameOf(const metrics::EgoContact& contact, bool excuses_unavoidable);

/// Whose fault the ego's contacts were, by the same count as the verdict: "the ego was not at
/// fault", "the ego was at fault in 1 of them". Empty without contacts.
std::string faultText(const session::ScenarioOptions& options,
                      const std::vector<metrics::EgoContact>& contacts);

/// A reason names this many contacts of a kind, then counts the rest.
inline constexpr std::size_t kShownContacts = 3;

/// "CBV bg_1", "background vehicle bg_7": the other vehicle of a contact, for people.
std::string partnerText(const metrics::EgoContact& contact);

/// "CBV bg_1 at 5.85 s (the other's front struck the ego's rear ...)".
std::string contactText(const metrics::EgoContact& contact);

/// The contact that the verdict turned on: the first of the kind that decided it; where none did,
/// the first at fault, else the first. nullptr without contacts.
const metrics::EgoContact* decidingContact(const session::ScenarioOptions& options,
                                           const Verdict& verdict,
                                           const std::vector<metrics::EgoContact>& contacts);

}  // namespace cdiff::record

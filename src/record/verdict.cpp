// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/verdict.h"

#include <algorithm>
#include <cctype>
#include <optional>
#include <utility>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "metrics/known_measures.h"
#include "record/outcome.h"

namespace cdiff::record {
namespace {

namespace known = metrics::known;
using traffic::SessionStatus;

constexpr double kNoLimit = 1e9;  // default of the rules on counts
constexpr const char* kContactsAtFaultRule = "contacts_at_fault";
constexpr const char* kContactWithoutFaultRule = "contact_without_fault";

Check judged(const std::string& name, bool met, const std::string& text) {
  return {name, met ? CheckOutcome::kPassed : CheckOutcome::kFailed, text};
}

std::string quotedStatus(SessionStatus status) {
  return "'" + std::string(traffic::toText(status)) + "'";
}

Check sessionCheck(SessionStatus status, const std::vector<traffic::Fault>& faults) {
  const std::string text = "the session ended with status " + quotedStatus(status);
  if (endedByItself(status)) return {"session", CheckOutcome::kPassed, text};
  if (faults.empty()) return {"session", CheckOutcome::kError, text};
  return {"session", CheckOutcome::kError,
          text + ": " + faults.back().source + ": " + faults.back().text};
}

std::string countText(std::size_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

/// The ego's contacts as texts, by its part in them.
struct BlamedContacts {
  std::vector<std::string> fault;
  std::vector<std::string> excused;
  std::vector<std::string> struck;

  BlamedContacts(const metrics::SessionMeasures& measures, bool excuses) {
    for (const metrics::EgoContact& contact : measures.ego_contacts) {
      const Blame blame = blameOf(contact, excuses);
      std::vector<std::string>& texts = blame == Blame::kFault     ? fault
                                        : blame == Blame::kExcused ? excused
                                                                   : struck;
      texts.push_back(contactText(contact));
    }
  }
};

/// "with A; with B; with C; and 20 more": the first contacts after a preposition.
std::string firstTexts(const std::vector<std::string>& contacts, const std::string& preposition) {
  const std::size_t shown = std::min(contacts.size(), kShownContacts);
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < shown; ++i) parts.push_back(preposition + " " + contacts[i]);
  if (contacts.size() > shown)
    parts.push_back("and " + std::to_string(contacts.size() - shown) + " more");
  return core::joinText(parts, "; ");
}

std::string atFaultText(const std::vector<std::string>& contacts) {
  return "the ego was at fault in " + countText(contacts.size(), "contact") + ": " +
         firstTexts(contacts, "with");
}

std::string struckText(const std::vector<std::string>& contacts) {
  return "the ego was struck without fault in " + countText(contacts.size(), "contact") + ", " +
         firstTexts(contacts, "by");
}

std::string excusedText(const std::vector<std::string>& contacts) {
  return "no braking of the ego would have avoided " + countText(contacts.size(), "contact") +
         ", which excuses it: " + firstTexts(contacts, "with");
}

/// Of contacts that are not, or not wholly, the ego's fault.
std::vector<std::string> faultlessTexts(const BlamedContacts& contacts) {
  std::vector<std::string> texts;
  if (!contacts.struck.empty()) texts.push_back(struckText(contacts.struck));
  if (!contacts.excused.empty()) texts.push_back(excusedText(contacts.excused));
  return texts;
}

/// Adds a check for each rule that the scenario sets.
class VerdictRules {
 public:
  VerdictRules(const session::ScenarioOptions& options, SessionStatus status,
               const metrics::SessionMeasures& measures)
      : rules_(options.verdict),
        mode_(options.fiercestMode()),
        status_(status),
        measures_(measures) {}

  std::vector<Check> checks() {
    if (!rules_.judge) return {};
    addStatus();
    addCompletion();
    addDistance();
    addContacts();
    addScore();
    addCollisions();
    addInfraction({"red_lights", known::kRedLights, "red lights that the ego ran"},
                  rules_.maximum_red_lights, kNoLimit);
    addInfraction({"stop_signs", known::kStopSigns, "stop signs that the ego did not obey"},
                  rules_.maximum_stop_signs, kNoLimit);
    addInfraction({"outside_lanes_percent", known::kOutsideLanes,
                   "share of its route that the ego drove outside the lanes"},
                  rules_.maximum_outside_lanes_percent, 100.0);
    addOffRoad();
    return std::move(checks_);
  }

 private:
  void addStatus() {
    const auto& allowed = rules_.statuses;
    if (allowed.empty()) return;
    const bool met =
        std::find(allowed.begin(), allowed.end(), traffic::toText(status_)) != allowed.end();
    checks_.push_back(judged("status", met,
                             "the session ended with status " + quotedStatus(status_) +
                                 "; allowed: " + core::joinText(allowed, ", ")));
  }

  /// The value that a rule is on; where there is none, the rule is skipped.
  std::optional<double> valueOrSkip(const std::string& rule,
                                    const metrics::MeasureDefinition& definition) {
    const metrics::Measure found = measures_.at(definition);
    if (!found.value)
      checks_.push_back({rule, CheckOutcome::kSkipped, rule + " is not defined: " + found.reason});
    return found.value;
  }

  void addCompletion() {
    const double least = rules_.minimum_route_completion;
    if (least <= 0.0) return;
    const auto percent = valueOrSkip("route_completion", known::kRouteCompletion);
    if (!percent) return;
    checks_.push_back(judged("route_completion", *percent >= least,
                             "the ego completed " + core::formatFixed(*percent, 1) +
                                 " % of its route; at least " + core::formatNumber(least) +
                                 " % is asked"));
  }

  void addDistance() {
    const double least = rules_.minimum_ego_distance;
    if (least <= 0.0) return;
    const auto meters = valueOrSkip("ego_distance", known::kEgoDistance);
    if (!meters) return;
    checks_.push_back(judged("ego_distance", *meters >= least,
                             "the ego drove " + core::formatFixed(*meters, 1) + " m; at least " +
                                 core::formatNumber(least) + " m is asked"));
  }

  void addContacts() {
    const BlamedContacts contacts(measures_, rules_.excusesUnavoidable(mode_));
    const std::vector<std::string>& own = contacts.fault;
    const double most = rules_.maximum_contacts_at_fault;
    if (most < kNoLimit) {
      checks_.push_back(judged(kContactsAtFaultRule, static_cast<double>(own.size()) <= most,
                               "the ego was at fault in " + countText(own.size(), "contact") +
                                   "; at most " + core::formatNumber(most) + " allowed" +
                                   (own.empty() ? "" : ": " + firstTexts(own, "with"))));
    }
    addContactsWithoutFault(faultlessTexts(contacts));
  }

  void addContactsWithoutFault(const std::vector<std::string>& texts) {
    std::string meaning = rules_.contact_without_fault;
    if (meaning == "allowed") return;
    const bool by_mode = meaning == "by_mode";
    if (by_mode) meaning = mode_ != "naturalistic" ? "struck" : "failed";
    Check check{kContactWithoutFaultRule, CheckOutcome::kPassed, "no vehicle struck the ego"};
    if (!texts.empty()) {
      check.outcome = meaning == "struck" ? CheckOutcome::kStruck : CheckOutcome::kFailed;
      check.text = core::joinText(texts, "; ") +
                   (by_mode ? "; in mode " + mode_ + " that counts as " + meaning : "");
    }
    checks_.push_back(check);
  }

  void addScore() {
    if (rules_.minimum_driving_score <= 0.0) return;
    const auto score = valueOrSkip("driving_score", known::kDrivingScore);
    if (!score) return;
    checks_.push_back(judged("driving_score", *score >= rules_.minimum_driving_score,
                             "the ego's driving score by " + measures_.protocol + " was " +
                                 core::formatFixed(*score, 1) + " %; at least " +
                                 core::formatNumber(rules_.minimum_driving_score) + " % is asked"));
  }

  void addCollisions() {
    const double limit = rules_.maximum_ego_collisions;
    if (limit >= kNoLimit) return;
    const auto value = valueOrSkip(known::kEgoCollisions.name, known::kEgoCollisions);
    if (!value) return;
    const auto count = static_cast<std::size_t>(*value);
    checks_.push_back(judged(known::kEgoCollisions.name, *value <= limit,
                             "the ego had " + countText(count, "collision") + "; at most " +
                                 core::formatNumber(limit) + " allowed"));
  }

  /// A rule on one of the ego's infractions.
  struct InfractionRule {
    const char* name;
    const metrics::MeasureDefinition& definition;
    const char* what;
  };

  /// `none` is the limit that allows all.
  void addInfraction(const InfractionRule& rule, double limit, double none) {
    if (limit >= none) return;
    if (!valueOrSkip(rule.name, rule.definition)) return;
    const metrics::Measure found = measures_.at(rule.definition);
    const std::string unit = found.unit.empty() ? "" : " " + found.unit;
    checks_.push_back(judged(rule.name, *found.value <= limit,
                             std::string(rule.what) + ": " +
                                 core::formatFixed(*found.value, unit.empty() ? 0 : 2) + unit +
                                 "; at most " + core::formatNumber(limit) + unit + " allowed"));
  }

  void addOffRoad() {
    const double limit = rules_.maximum_cbv_off_road_percent;
    if (limit >= 100.0) return;
    const auto rate = valueOrSkip("cbv_off_road", known::kCbvOffRoad);
    if (!rate) return;
    checks_.push_back(judged("cbv_off_road", *rate <= limit,
                             "the CBVs were off the road " + core::formatFixed(*rate, 2) +
                                 " % of their time; at most " + core::formatNumber(limit) +
                                 " % allowed"));
  }

  const session::VerdictOptions& rules_;
  std::string mode_;
  SessionStatus status_;
  const metrics::SessionMeasures& measures_;
  std::vector<Check> checks_;
};

bool has(const std::vector<Check>& checks, CheckOutcome outcome) {
  return std::any_of(checks.begin(), checks.end(),
                     [outcome](const Check& check) { return check.outcome == outcome; });
}

Outcome outcomeFrom(SessionStatus status, const std::vector<Check>& checks) {
  if (status == SessionStatus::kInterrupted) return Outcome::kInterrupted;
  if (!endedByItself(status)) return Outcome::kError;
  if (checks.size() == 1) return Outcome::kNotJudged;
  if (has(checks, CheckOutcome::kFailed)) return Outcome::kFailed;
  return has(checks, CheckOutcome::kStruck) ? Outcome::kStruck : Outcome::kPassed;
}

/// Why a session is not judged, and what is worth knowing of it all the same.
std::vector<std::string> reasonsNotToJudge(const session::ScenarioOptions& options,
                                           const metrics::SessionMeasures& measures,
                                           const std::string& by_hand) {
  std::vector<std::string> reasons = {
      !by_hand.empty() ? by_hand
      : options.verdict.judge
          ? "the scenario has no rules (group 'verdict'): the session cannot fail, whatever the "
            "ego does"
          : "the scenario is not to be judged (verdict.judge is false)"};
  const BlamedContacts contacts(measures,
                                options.verdict.excusesUnavoidable(options.fiercestMode()));
  if (!contacts.fault.empty()) reasons.push_back(atFaultText(contacts.fault));
  for (const std::string& text : faultlessTexts(contacts)) reasons.push_back(text);
  return reasons;
}

/// Empty unless the session was steered by hand.
std::string byHandText(const std::vector<session::SteeringRecord>& steering) {
  std::size_t count = 0;
  for (const session::SteeringRecord& record : steering) count += record.byHand() ? 1 : 0;
  if (count == 0) return "";
  return "the session was steered by hand in " + countText(count, "change") +
         "; as a scenario it can be judged (cdiff steering)";
}

/// Notes the checks that made the outcome.
void addReasons(Verdict& verdict) {
  for (const Check& check : verdict.checks) {
    const bool decided =
        check.outcome != CheckOutcome::kPassed && check.outcome != CheckOutcome::kSkipped;
    if (!decided) continue;
    verdict.reasons.push_back(check.text);
    verdict.decided_by.push_back(check.name);
  }
}

}  // namespace

bool endedByItself(SessionStatus status) {
  return status != SessionStatus::kError && status != SessionStatus::kInterrupted &&
         status != SessionStatus::kRunning;
}

Verdict judge(const session::ScenarioOptions& options, SessionStatus status,
              const metrics::SessionMeasures& measures, const std::vector<traffic::Fault>& faults,
              const std::vector<session::SteeringRecord>& steering) {
  Verdict verdict;
  verdict.checks = {sessionCheck(status, faults)};
  const std::string by_hand = byHandText(steering);
  std::vector<Check> rules;
  if (by_hand.empty()) rules = VerdictRules(options, status, measures).checks();
  for (Check& check : rules) {
    if (!endedByItself(status)) {
      check.outcome = CheckOutcome::kSkipped;
      check.text = "not judged: the session ended with status " + quotedStatus(status);
    }
    verdict.checks.push_back(std::move(check));
  }
  verdict.outcome = outcomeFrom(status, verdict.checks);
  if (verdict.outcome == Outcome::kNotJudged)
    verdict.reasons = reasonsNotToJudge(options, measures, by_hand);
  else
    addReasons(verdict);
  return verdict;
}

Blame blameOf(const metrics::EgoContact& contact, bool excuses_unavoidable) {
  if (!contact.ego_at_fault) return Blame::kNone;
  return excuses_unavoidable && !contact.braking_avoids ? Blame::kExcused : Blame::kFault;
}

std::string faultText(const session::ScenarioOptions& options,
                      const std::vector<metrics::EgoContact>& contacts) {
  if (contacts.empty()) return "";
  const bool excuses = options.verdict.excusesUnavoidable(options.fiercestMode());
  const auto count = [&](Blame blame) {
    return std::count_if(contacts.begin(), contacts.end(),
                         [&](const auto& contact) { return blameOf(contact, excuses) == blame; });
  };
  const auto fault = count(Blame::kFault);
  const auto excused = count(Blame::kExcused);
  if (contacts.size() == 1 && excused > 0)
    return "the ego is excused, as no braking would have avoided it";
  if (contacts.size() == 1) return fault > 0 ? "the ego was at fault" : "the ego was not at fault";
  if (fault == 0 && excused > 0) {
    return "the ego is excused in " + std::to_string(excused) +
           " of them, which no braking would have avoided";
  }
  return "the ego was at fault in " + (fault == 0 ? "none" : std::to_string(fault)) + " of them" +
         (excused == 0 ? ""
                       : ", and is excused in " + std::to_string(excused) +
                             " that no braking would have avoided");
}

std::string partnerText(const metrics::EgoContact& contact) {
  return (contact.with_cbv ? "CBV " : "background vehicle ") + contact.partner;
}

std::string contactText(const metrics::EgoContact& contact) {
  return partnerText(contact) + " at " + core::formatFixed(contact.seconds, 2) + " s (" +
         contact.reason + ")";
}

const metrics::EgoContact* decidingContact(const session::ScenarioOptions& options,
                                           const Verdict& verdict,
                                           const std::vector<metrics::EgoContact>& contacts) {
  if (contacts.empty()) return nullptr;
  const bool excuses = options.verdict.excusesUnavoidable(options.fiercestMode());
  const auto decided = [&](const char* rule) {
    const auto& rules = verdict.decided_by;
    return std::find(rules.begin(), rules.end(), rule) != rules.end();
  };
  const bool by_others = !decided(kContactsAtFaultRule) && decided(kContactWithoutFaultRule);
  const auto found =
      std::find_if(contacts.begin(), contacts.end(), [&](const metrics::EgoContact& contact) {
        return (blameOf(contact, excuses) == Blame::kFault) != by_others;
      });
  return found == contacts.end() ? &contacts.front() : &*found;
}

}  // namespace cdiff::record

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/outcome.h"

#include <cctype>
#include <utility>

#include "core/program.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::record {
namespace {

constexpr std::pair<Outcome, const char*> kOutcomes[] = {
    {Outcome::kPassed, "passed"}, {Outcome::kStruck, "struck"},
    {Outcome::kFailed, "failed"}, {Outcome::kNotJudged, "not_judged"},
    {Outcome::kError, "error"},   {Outcome::kInterrupted, "interrupted"}};

}  // namespace

const char* toText(Outcome outcome) {
  for (const auto& [each, text] : kOutcomes) {
    if (each == outcome) return text;
  }
  return "error";
}

std::string wordOf(Outcome outcome) {
  return outcome == Outcome::kNotJudged ? "not judged" : toText(outcome);
}

std::string capitalsOf(Outcome outcome) {
  std::string text = wordOf(outcome);
  for (char& letter : text) letter = static_cast<char>(std::toupper(letter));
  return text;
}

Outcome outcomeOf(const std::string& text) {
  for (const auto& [outcome, name] : kOutcomes) {
    if (text == name) return outcome;
  }
  throw core::InputError("'" + text + "' is no outcome of a session");
}

int exitCodeOf(Outcome outcome) {
  if (outcome == Outcome::kInterrupted) return core::ExitCode::kInterrupted;
  if (outcome == Outcome::kError) return core::ExitCode::kRunTimeError;
  return outcome == Outcome::kFailed ? core::ExitCode::kVerdictFailed : core::ExitCode::kPassed;
}

const char* toText(CheckOutcome outcome) {
  constexpr const char* kTexts[] = {"passed", "struck", "failed", "error", "skipped"};
  return kTexts[static_cast<std::size_t>(outcome)];
}

}  // namespace cdiff::record

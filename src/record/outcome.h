// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::record {

/// How a session ended.
enum class Outcome {
  kPassed,
  kStruck,     ///< passed, but with contacts that are not the ego's fault or are excused
  kFailed,     ///< a rule was not met
  kNotJudged,  ///< ended by itself, without any rule
  kError,      ///< broke
  kInterrupted
};

/// "passed", "struck", "failed", "not_judged", "error" or "interrupted": in files.
const char* toText(Outcome outcome);
/// The same for people: "not judged".
std::string wordOf(Outcome outcome);
/// In capitals: "NOT JUDGED".
std::string capitalsOf(Outcome outcome);
/// Throws InputError for any other text.
Outcome outcomeOf(const std::string& text);
/// One of core::ExitCode: of `cdiff`, scripts/session and the file exit_code.
int exitCodeOf(Outcome outcome);

/// The outcome of one check of a session.
enum class CheckOutcome { kPassed, kStruck, kFailed, kError, kSkipped };

/// "passed", "struck", "failed", "error" or "skipped".
const char* toText(CheckOutcome outcome);

}  // namespace cdiff::record

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>
#include <vector>

#include "record/session_result.h"

namespace cdiff::record {

// The file junit.xml, by which continuous integration reads a session or a batch (format: Apache
// Ant's JUnit report). Written by record and evaluation; times are seconds of wall time.

/// A test case of a JUnit file: one rule of a session, or one run of a batch.
struct JunitCase {
  enum class Kind { kPassed, kSkipped, kFailure, kError };
  Kind kind = Kind::kPassed;
  std::string name;
  double seconds = 0.0;
  std::string message;  ///< why it failed; of a passed case a remark, written to <system-out>
  std::string type;     ///< type of a failure or an error
  std::string text;     ///< content of a failure or an error, beside the message
};

/// A test suite of a JUnit file: its cases and properties.
struct JunitSuite {
  std::string name;  ///< also in "e2e_cdiff.NAME", the class of its cases
  double seconds = 0.0;
  std::map<std::string, std::string> properties = {};
  std::vector<JunitCase> cases = {};
};

/// Content of the file. Characters that XML forbids become U+FFFD (`core::plainText`).
std::string junitText(const JunitSuite& suite);

/// Content of a session's junit.xml: one case for the session and one per rule of its scenario. A
/// rule that was not met is a failure, a session that broke an error; what was struck or not judged
/// counts as passed, with a remark. The property "verdict" holds the outcome.
std::string junitXml(const SessionResult& result);

}  // namespace cdiff::record

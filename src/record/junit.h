// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>
#include <vector>

#include "record/session_result.h"

namespace cdiff::record {

// Text of junit.xml: test cases of one suite.

/// A case of a JUnit file.
struct JunitCase {
  enum class Kind { kPassed, kSkipped, kFailure, kError };
  Kind kind = Kind::kPassed;
  std::string name;
  double seconds = 0.0;
  std::string message;  ///< for a case that counts as passed: what it has to say, in <system-out>
  std::string type;     ///< type of a failure or an error
  std::string text;     ///< content of a failure or an error, beside the message
};

/// A suite of a JUnit file with its cases.
struct JunitSuite {
  std::string name;  ///< also in "e2e_cdiff.NAME", the class of its cases
  double seconds = 0.0;
  std::map<std::string, std::string> properties = {};
  std::vector<JunitCase> cases = {};
};

/// What XML forbids in names and texts becomes U+FFFD (`core::plainText`).
std::string junitText(const JunitSuite& suite);

/// One case for the session and one per rule of its scenario; a rule not met is a failure, a
/// session that broke is an error. What was struck or not judged counts as passed and says so; the
/// property "verdict" holds the outcome.
std::string junitXml(const SessionResult& result);

}  // namespace cdiff::record

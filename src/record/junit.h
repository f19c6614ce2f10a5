// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Text of junit.xml: one test case for the session and one per rule of its scenario; a rule not
/// met is a failure, a session that broke is an error. What was struck or not judged counts as
/// passed and says so in <system-out>; the property "verdict" holds the outcome.
#pragma once

#include <string>

#include "record/session_result.h"

namespace cdiff::record {

std::string junitXml(const SessionResult& result);

}  // namespace cdiff::record

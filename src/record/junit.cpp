// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/junit.h"

#include <algorithm>

#include "core/markup.h"
#include "core/text.h"

namespace cdiff::record {
namespace {

std::string attribute(const std::string& name, const std::string& value) {
  return " " + name + "=\"" + core::escapeMarkup(value) + "\"";
}

/// What a case that counts as passed has to say; empty for most.
std::string noteOf(const SessionResult& result, const Check& check) {
  if (check.outcome == CheckOutcome::kStruck) return "struck: " + check.text;
  const bool not_judged = result.verdict.outcome == Outcome::kNotJudged;
  return not_judged ? "not judged: " + core::joinText(result.verdict.reasons, "; ") : "";
}

std::string caseXml(const SessionResult& result, const Check& check) {
  const bool session = check.name == "session";
  std::string text = "    <testcase" +
                     attribute("classname", "e2e_cdiff." + result.setup.options().name) +
                     attribute("name", check.name) +
                     attribute("time", session ? core::formatFixed(result.wall_seconds, 3) : "0");
  const std::string note = noteOf(result, check);
  if (check.outcome == CheckOutcome::kPassed && note.empty()) return text + "/>\n";
  const std::string type = traffic::toText(result.status);
  text += ">\n      ";
  if (!note.empty()) {
    text += "<system-out>" + core::escapeMarkup(note) + "</system-out>";
  } else if (check.outcome == CheckOutcome::kSkipped) {
    text += "<skipped" + attribute("message", check.text) + "/>";
  } else {
    const std::string tag = check.outcome == CheckOutcome::kError ? "error" : "failure";
    text += "<" + tag + attribute("type", session ? type : check.name) +
            attribute("message", check.text) + ">" + core::escapeMarkup(check.text) + "</" + tag +
            ">";
  }
  return text + "\n    </testcase>\n";
}

std::string countOf(const std::vector<Check>& checks, CheckOutcome outcome) {
  return std::to_string(std::count_if(checks.begin(), checks.end(), [outcome](const Check& check) {
    return check.outcome == outcome;
  }));
}

}  // namespace

std::string junitXml(const SessionResult& result) {
  const std::vector<Check>& checks = result.verdict.checks;
  const std::string counts = attribute("tests", std::to_string(checks.size())) +
                             attribute("failures", countOf(checks, CheckOutcome::kFailed)) +
                             attribute("errors", countOf(checks, CheckOutcome::kError)) +
                             attribute("skipped", countOf(checks, CheckOutcome::kSkipped)) +
                             attribute("time", core::formatFixed(result.wall_seconds, 3));
  std::string text = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites" + counts +
                     ">\n  <testsuite" + attribute("name", result.setup.options().name) + counts +
                     ">\n    <properties>\n      <property" + attribute("name", "verdict") +
                     attribute("value", toText(result.verdict.outcome)) + "/>\n    </properties>\n";
  for (const Check& check : checks) text += caseXml(result, check);
  return text + "  </testsuite>\n</testsuites>\n";
}

}  // namespace cdiff::record

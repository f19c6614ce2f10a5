// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/junit.h"

#include <algorithm>
#include <pugixml.hpp>
#include <sstream>

#include "core/markup.h"
#include "core/text.h"

namespace cdiff::record {
namespace {

using Kind = JunitCase::Kind;

void setAttribute(pugi::xml_node node, const char* name, const std::string& value) {
  node.append_attribute(name).set_value(core::plainText(value).c_str());
}

void setText(pugi::xml_node node, const std::string& text) {
  node.text().set(core::plainText(text).c_str());
}

std::string secondsText(double seconds) { return core::formatFixed(seconds, 3); }

void setCounts(pugi::xml_node node, const JunitSuite& suite) {
  const auto count = [&suite](Kind kind) {
    return std::to_string(
        std::count_if(suite.cases.begin(), suite.cases.end(),
                      [kind](const JunitCase& junit) { return junit.kind == kind; }));
  };
  setAttribute(node, "tests", std::to_string(suite.cases.size()));
  setAttribute(node, "failures", count(Kind::kFailure));
  setAttribute(node, "errors", count(Kind::kError));
  setAttribute(node, "skipped", count(Kind::kSkipped));
  setAttribute(node, "time", secondsText(suite.seconds));
}

void addCase(pugi::xml_node suite, const std::string& name, const JunitCase& junit) {
  pugi::xml_node node = suite.append_child("testcase");
  setAttribute(node, "classname", "e2e_cdiff." + name);
  setAttribute(node, "name", junit.name);
  setAttribute(node, "time", secondsText(junit.seconds));
  if (junit.kind == Kind::kPassed) {
    if (!junit.message.empty()) setText(node.append_child("system-out"), junit.message);
    return;
  }
  const bool skipped = junit.kind == Kind::kSkipped;
  pugi::xml_node found = node.append_child(skipped                      ? "skipped"
                                           : junit.kind == Kind::kError ? "error"
                                                                        : "failure");
  if (!skipped) setAttribute(found, "type", junit.type);
  setAttribute(found, "message", junit.message);
  if (!junit.text.empty()) setText(found, junit.text);
}

void addProperties(pugi::xml_node suite, const std::map<std::string, std::string>& properties) {
  if (properties.empty()) return;
  pugi::xml_node list = suite.append_child("properties");
  for (const auto& [name, value] : properties) {
    pugi::xml_node property = list.append_child("property");
    setAttribute(property, "name", name);
    setAttribute(property, "value", value);
  }
}

/// The test case of one check of a session. A check that was struck, or whose session is not
/// judged, counts as passed; its message says so.
JunitCase caseOf(const SessionResult& result, const Check& check) {
  const bool session = check.name == "session";
  JunitCase junit;
  junit.name = check.name;
  junit.seconds = session ? result.wall_seconds : 0.0;
  if (check.outcome == CheckOutcome::kStruck) {
    junit.message = "struck: " + check.text;
  } else if (result.verdict.outcome == Outcome::kNotJudged) {
    junit.message = "not judged: " + core::joinText(result.verdict.reasons, "; ");
  } else if (check.outcome != CheckOutcome::kPassed) {
    junit.kind = check.outcome == CheckOutcome::kSkipped ? Kind::kSkipped
                 : check.outcome == CheckOutcome::kError ? Kind::kError
                                                         : Kind::kFailure;
    junit.type = session ? traffic::toText(result.status) : check.name;
    junit.message = check.text;
    junit.text = junit.kind == Kind::kSkipped ? "" : check.text;
  }
  return junit;
}

}  // namespace

std::string junitText(const JunitSuite& suite) {
  pugi::xml_document document;
  pugi::xml_node declaration = document.append_child(pugi::node_declaration);
  setAttribute(declaration, "version", "1.0");
  setAttribute(declaration, "encoding", "UTF-8");
  pugi::xml_node root = document.append_child("testsuites");
  setCounts(root, suite);
  pugi::xml_node node = root.append_child("testsuite");
  setAttribute(node, "name", suite.name);
  setCounts(node, suite);
  addProperties(node, suite.properties);
  for (const JunitCase& junit : suite.cases) addCase(node, suite.name, junit);
  std::ostringstream text;
  document.save(text, "  ");
  return text.str();
}

std::string junitXml(const SessionResult& result) {
  JunitSuite suite{result.setup.options().name, result.wall_seconds};
  suite.properties["verdict"] = toText(result.verdict.outcome);
  for (const Check& check : result.verdict.checks) suite.cases.push_back(caseOf(result, check));
  return junitText(suite);
}

}  // namespace cdiff::record

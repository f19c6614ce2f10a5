// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cli/scenario_keys.h"

#include <algorithm>
#include <map>
#include <vector>

#include "core/option_fields.h"
#include "core/spelling.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "session/session_request.h"

namespace cdiff::cli {
namespace {

using FlatValues = std::map<std::string, std::string>;

/// A line of the options as YAML: two spaces of indentation a level.
struct Line {
  std::string text;
  std::string group;  ///< of the first level; the key itself where that is no group
  std::string path;   ///< full key; empty for a comment
};

/// Lines with what they belong to; a comment belongs to the key below it.
std::vector<Line> linesOf(const std::string& yaml) {
  std::vector<Line> lines;
  std::vector<std::string> path;
  std::size_t comments = 0;
  for (const std::string& text : core::splitText(yaml, '\n')) {
    lines.push_back({text, "", ""});
    const std::size_t indent = text.find_first_not_of(' ');
    if (indent == std::string::npos) continue;
    if (text[indent] == '#') {
      ++comments;
      continue;
    }
    path.resize(indent / 2);
    path.push_back(text.substr(indent, text.find(':') - indent));
    lines.back().path = core::joinText(path, ".");
    for (std::size_t i = lines.size() - 1 - comments; i < lines.size(); ++i)
      lines[i].group = path.front();
    comments = 0;
  }
  return lines;
}

/// Groups of the first level: what has keys below it.
std::vector<std::string> groupsOf(const FlatValues& values) {
  std::vector<std::string> groups;
  for (const auto& [key, value] : values) {
    const std::string group = key.substr(0, key.find('.'));
    if (group != key && (groups.empty() || groups.back() != group)) groups.push_back(group);
  }
  std::sort(groups.begin(), groups.end());
  groups.erase(std::unique(groups.begin(), groups.end()), groups.end());
  return groups;
}

void requireGroup(const std::string& group, const FlatValues& values) {
  const std::vector<std::string> groups = groupsOf(values);
  if (group.empty() || std::find(groups.begin(), groups.end(), group) != groups.end()) return;
  throw core::InputError("a scenario has no group '" + core::shortened(group) + "'" +
                         core::didYouMean(group, groups) +
                         "; groups: " + core::joinText(groups, ", "));
}

}  // namespace

std::string scenarioKeys(const session::ScenarioOptions& options, const std::string& group) {
  const FlatValues values = core::flatOptions(options);
  const FlatValues usual = core::flatOptions(session::defaultScenario());
  requireGroup(group, values);
  std::string yaml;
  for (const Line& line : linesOf(core::dumpOptions(options, true))) {
    if (!group.empty() && line.group != group) continue;
    const auto value = values.find(line.path);
    const auto before = usual.find(line.path);
    const bool differs =
        value != values.end() && before != usual.end() && value->second != before->second;
    yaml += line.text + (differs ? "  # default: " + before->second : "") + "\n";
  }
  return yaml;
}

}  // namespace cdiff::cli

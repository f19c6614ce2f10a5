// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/option_fields.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "core/spelling.h"
#include "core/text.h"
#include "core/yaml_text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/options.h"

namespace cdiff::core {

void OptionsVisitor::joinedTexts(const FieldInfo& info, std::string& value, char) {
  text(info, value, {});
}

}  // namespace cdiff::core

namespace cdiff::core::detail {
namespace {

/// Collects the full path of every leaf and group.
class PathVisitor : public OptionsVisitor {
 public:
  void number(const FieldInfo& info, double&, double, double) override { add(info); }
  void integer(const FieldInfo& info, std::int64_t&, std::int64_t, std::int64_t) override {
    add(info);
  }
  void flag(const FieldInfo& info, bool&) override { add(info); }
  void text(const FieldInfo& info, std::string&, const std::vector<std::string>& choices) override {
    add(info);
    if (!choices.empty()) choices_[paths_.back()] = " (one of {" + joinText(choices, ", ") + "})";
  }
  void list(const FieldInfo& info, std::vector<std::string>&) override { add(info); }
  void points(const FieldInfo& info, std::vector<Eigen::Vector3d>&) override { add(info); }
  bool enter(const FieldInfo& info) override {
    add(info);
    prefixes_.push_back(prefix() + info.key + ".");
    return true;
  }
  void leave() override { prefixes_.pop_back(); }
  bool enterGroups(const FieldInfo& info) override {
    add(info);
    return false;
  }

  const std::vector<std::string>& paths() const { return paths_; }
  /// " (one of {a, b})", or nothing.
  std::string choicesOf(const std::string& path) const {
    const auto found = choices_.find(path);
    return found == choices_.end() ? "" : found->second;
  }

 private:
  std::string prefix() const { return prefixes_.empty() ? "" : prefixes_.back(); }
  void add(const FieldInfo& info) { paths_.push_back(prefix() + info.key); }
  std::vector<std::string> prefixes_;
  std::vector<std::string> paths_;
  std::map<std::string, std::string> choices_;  ///< as text, by path
};

std::string lastPart(const std::string& path) { return path.substr(path.rfind('.') + 1); }

/// Writes the fields as indented YAML.
class DumpVisitor : public OptionsVisitor {
 public:
  explicit DumpVisitor(bool with_comments) : with_comments_(with_comments) {}

  void number(const FieldInfo& info, double& value, double minimum, double maximum) override {
    line(info, formatNumber(value), rangeText(minimum, maximum, info.unit));
  }
  void integer(const FieldInfo& info, std::int64_t& value, std::int64_t minimum,
               std::int64_t maximum) override {
    line(info, std::to_string(value), rangeText(minimum, maximum, info.unit));
  }
  void flag(const FieldInfo& info, bool& value) override {
    line(info, value ? "true" : "false", "true | false");
  }
  void text(const FieldInfo& info, std::string& value,
            const std::vector<std::string>& choices) override {
    line(info, yamlQuoted(value), joinText(choices, " | "));
  }
  void list(const FieldInfo& info, std::vector<std::string>& value) override {
    std::vector<std::string> items;
    for (const std::string& item : value) items.push_back(yamlQuoted(item));
    line(info, "[" + joinText(items, ", ") + "]", "");
  }
  void points(const FieldInfo& info, std::vector<Eigen::Vector3d>& value) override {
    std::vector<std::string> items;
    for (const Eigen::Vector3d& item : value) {
      items.push_back("[" + formatNumber(item.x()) + ", " + formatNumber(item.y()) + ", " +
                      formatNumber(item.z()) + "]");
    }
    line(info, "[" + joinText(items, ", ") + "]", info.unit);
  }
  bool enter(const FieldInfo& info) override {
    comment(info, "");
    text_ += indent_ + info.key + ":\n";
    indent_ += "  ";
    return true;
  }
  void leave() override {
    if (items_) {
      items_->back() = "{" + items_->back() + "}";
    } else {
      indent_.resize(indent_.size() - 2);
    }
  }
  /// On one line.
  bool enterGroups(const FieldInfo& info) override {
    comment(info, "");
    text_ += indent_ + info.key + ": ";
    items_.emplace();
    return true;
  }
  void leaveGroups() override {
    text_ += "[" + joinText(*items_, ", ") + "]\n";
    items_.reset();
  }
  void enterItem(std::size_t) override { items_->emplace_back(); }

  const std::string& written() const { return text_; }

 private:
  void comment(const FieldInfo& info, const std::string& range) {
    if (!with_comments_) return;
    text_ += indent_ + "# " + info.text + (range.empty() ? "" : " " + range) + "\n";
  }
  void line(const FieldInfo& info, const std::string& value, const std::string& range) {
    if (items_) {
      std::string& item = items_->back();
      item += (item.empty() ? "" : ", ") + std::string(info.key) + ": " + value;
      return;
    }
    comment(info, range);
    text_ += indent_ + info.key + ": " + value + "\n";
  }

  bool with_comments_;
  std::string indent_;
  std::string text_;
  std::optional<std::vector<std::string>> items_;  ///< of the list being written
};

class RangeVisitor : public OptionsVisitor {
 public:
  explicit RangeVisitor(const std::string& subject) : subject_(subject) {}

  void number(const FieldInfo& info, double& value, double minimum, double maximum) override {
    if (value >= minimum && value <= maximum) return;
    fail(info, formatNumber(value), "a number in " + rangeText(minimum, maximum, info.unit));
  }
  void integer(const FieldInfo& info, std::int64_t& value, std::int64_t minimum,
               std::int64_t maximum) override {
    if (value >= minimum && value <= maximum) return;
    fail(info, std::to_string(value),
         "a whole number in " + rangeText(minimum, maximum, info.unit));
  }
  void text(const FieldInfo& info, std::string& value,
            const std::vector<std::string>& choices) override {
    const bool known = std::find(choices.begin(), choices.end(), value) != choices.end();
    if (!known && !choices.empty())
      fail(info, "'" + value + "'", "one of {" + joinText(choices, ", ") + "}");
  }
  void flag(const FieldInfo&, bool&) override {}
  void list(const FieldInfo&, std::vector<std::string>&) override {}
  void points(const FieldInfo&, std::vector<Eigen::Vector3d>&) override {}
  bool enter(const FieldInfo& info) override {
    groups_.emplace_back(info.key);
    return true;
  }
  void leave() override { groups_.pop_back(); }

 private:
  [[noreturn]] void fail(const FieldInfo& info, const std::string& value,
                         const std::string& expected) const {
    std::vector<std::string> path = groups_;
    path.emplace_back(info.key);
    throw InputError(subject_ + " option '" + joinText(path, ".") + "' is " + value +
                     "; expected " + expected);
  }

  const std::string& subject_;
  std::vector<std::string> groups_;
};

}  // namespace

std::string resolvePath(const std::string& key, const std::string& source, void* options,
                        Describe describe) {
  PathVisitor visitor;
  describe(options, visitor);
  const std::vector<std::string>& paths = visitor.paths();
  if (std::find(paths.begin(), paths.end(), key) != paths.end()) return key;
  std::vector<std::string> matches;
  for (const std::string& path : paths) {
    if (lastPart(path) == key) matches.push_back(path);
  }
  if (matches.size() == 1) return matches.front();
  if (matches.size() > 1) {
    throw InputError(source + ": key '" + key + "' is ambiguous; write one of {" +
                     joinText(matches, ", ") + "}");
  }
  // A key that has moved keeps its name.
  for (const std::string& path : paths) {
    if (lastPart(path) == lastPart(key)) matches.push_back(path);
  }
  throw InputError(source + ": unknown key '" + key + "'; the nearest known key is '" +
                   nearestName(key, matches.empty() ? paths : matches) + "'");
}

std::string keysInstead(const std::string& path, void* options, Describe describe) {
  PathVisitor visitor;
  describe(options, visitor);
  std::vector<std::string> below;
  std::vector<std::string> beside;
  for (const std::string& key : visitor.paths()) {
    const bool longer = key.size() > path.size() && key.compare(0, path.size(), path) == 0;
    const bool direct = longer && key.find('.', path.size() + 1) == std::string::npos;
    if (direct && key[path.size()] == '.') below.push_back(key + visitor.choicesOf(key));
    if (direct && key[path.size()] == '_') beside.push_back(key);
  }
  if (below.empty()) return "";
  below.insert(below.end(), beside.begin(), beside.end());
  return joinText(below, ", ");
}

std::string rangeText(double low, double high, const char* unit) {
  const auto plain = [](double value) {
    constexpr double kMostDigits = 1e15;
    const bool whole = value == std::floor(value) && std::abs(value) < kMostDigits;
    return whole ? formatFixed(value, 0) : formatNumber(value);
  };
  const std::string range = "[" + plain(low) + ", " + plain(high) + "]";
  return unit[0] == '\0' ? range : range + " " + unit;
}

std::map<std::string, std::string> flatten(void* options, Describe describe) {
  std::map<std::string, std::string> values;
  std::vector<std::string> path;  // of the line, two spaces of indentation a level
  for (const std::string& line : splitText(dump(options, describe, false), '\n')) {
    const std::size_t indent = line.find_first_not_of(' ');
    const std::size_t colon = line.find(':');
    path.resize(indent / 2);
    path.push_back(line.substr(indent, colon - indent));
    if (colon + 2 < line.size()) values[joinText(path, ".")] = line.substr(colon + 2);
  }
  return values;
}

std::string dump(void* options, Describe describe, bool with_comments) {
  DumpVisitor visitor(with_comments);
  describe(options, visitor);
  return visitor.written();
}

void requireRanges(void* options, Describe describe, const std::string& subject) {
  RangeVisitor visitor(subject);
  describe(options, visitor);
}

}  // namespace cdiff::core::detail

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/core/options.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <optional>
#include <set>

#include "core/option_fields.h"
#include "core/spelling.h"
#include "core/text.h"
#include "core/yaml_text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core::detail {
namespace {

constexpr std::size_t kLongestText = 1 << 16;  // [bytes] of a key or value

/// Reads the fields that an options struct describes from a YAML map, and collects their keys, so
/// that a key that no field has can be refused with the nearest one. Throws InputError.
class LoadVisitor : public OptionsVisitor {
 public:
  /// `source` names the text in errors; `lines`: errors give the line, too.
  LoadVisitor(std::string source, YAML::Node root, bool lines)
      : source_(std::move(source)), lines_(lines) {
    push("", root);
  }

  void number(const FieldInfo& info, double& value, double minimum, double maximum) override {
    const YAML::Node node = take(info);
    if (!node) return;
    const std::string range = rangeText(minimum, maximum, info.unit);
    const auto parsed = node.IsScalar() ? parseNumber(node.Scalar()) : std::nullopt;
    if (!parsed) fail(node, info.key, "a number in " + range);
    if (*parsed < minimum || *parsed > maximum) fail(node, info.key, "a number in " + range);
    value = *parsed;
  }

  void integer(const FieldInfo& info, std::int64_t& value, std::int64_t minimum,
               std::int64_t maximum) override {
    const YAML::Node node = take(info);
    if (!node) return;
    const std::string range = rangeText(minimum, maximum, info.unit);
    try {
      std::size_t used = 0;
      const std::string text = node.IsScalar() ? node.Scalar() : "";
      const std::int64_t parsed = std::stoll(text, &used);
      if (used != text.size() || parsed < minimum || parsed > maximum) throw std::out_of_range("");
      value = parsed;
    } catch (const std::logic_error&) {
      fail(node, info.key, "a whole number in " + range);
    }
  }

  void flag(const FieldInfo& info, bool& value) override {
    const YAML::Node node = take(info);
    if (!node) return;
    if (!node.IsScalar() || !YAML::convert<bool>::decode(node, value)) {
      fail(node, info.key, "true or false");
    }
  }

  void text(const FieldInfo& info, std::string& value,
            const std::vector<std::string>& choices) override {
    const YAML::Node node = take(info);
    if (!node) return;
    const std::string choice = "one of {" + joinText(choices, ", ") + "}";
    if (!node.IsScalar())
      fail(node, info.key, choices.empty() ? "a text" : choice + ": " + info.text);
    const std::string& given = node.Scalar();
    if (!choices.empty() && std::find(choices.begin(), choices.end(), given) == choices.end()) {
      const std::string close = closeName(given, choices);
      fail(node, info.key,
           choice +
               (close.empty() ? ": " + std::string(info.text) : "; did you mean '" + close + "'?"));
    }
    value = given;
  }

  void joinedTexts(const FieldInfo& info, std::string& value, char separator) override {
    const YAML::Node node = levels_.back().node[info.key];
    if (!node || !node.IsSequence()) return text(info, value, {});
    std::vector<std::string> texts;
    list(info, texts);
    if (texts.empty()) fail(node, info.key, "a text, or a list of texts that is not empty");
    value = joinText(texts, std::string(1, separator));
  }

  void list(const FieldInfo& info, std::vector<std::string>& value) override {
    const YAML::Node node = take(info);
    if (!node) return;
    if (!node.IsSequence()) fail(node, info.key, "a list of texts, e.g. [a, b]");
    value.clear();
    for (const YAML::Node& item : node) {
      if (!item.IsScalar()) fail(item, info.key, "a list of texts, e.g. [a, b]");
      requireShort(item, info.key);
      value.push_back(item.Scalar());
    }
  }

  void points(const FieldInfo& info, std::vector<Eigen::Vector3d>& value) override {
    const YAML::Node node = take(info);
    if (!node) return;
    if (!node.IsSequence()) fail(node, info.key, "a list of points, e.g. [[0, 1], [2, 3]]");
    value.clear();
    for (const YAML::Node& item : node) value.push_back(point(info, item));
  }

  bool enter(const FieldInfo& info) override {
    const YAML::Node node = take(info);
    if (!node) {
      push(info.key, YAML::Node(YAML::NodeType::Map));
      return true;
    }
    if (!node.IsMap()) fail(node, info.key, "a group of keys");
    push(info.key, node);
    return true;
  }

  void leave() override {
    checkUnknownKeys();
    levels_.pop_back();
  }

  std::optional<std::size_t> givenGroups(const FieldInfo& info) override {
    const YAML::Node node = take(info);
    if (!node) return std::nullopt;
    const char* const expected = "a list of groups of keys, e.g. [{name: a}]";
    if (!node.IsSequence()) fail(node, info.key, expected);
    for (const YAML::Node& item : node) {
      if (!item.IsMap()) fail(item, info.key, expected);
    }
    return node.size();
  }

  bool enterGroups(const FieldInfo& info) override {
    const YAML::Node node = levels_.back().node[info.key];
    if (!node) return false;
    lists_.push_back({info.key, node});
    return true;
  }

  void leaveGroups() override { lists_.pop_back(); }

  void enterItem(std::size_t index) override {
    const List list = lists_.back();
    const YAML::Node item = list.node[index];
    const YAML::Node name = item["name"];
    const std::string which =
        name && name.IsScalar() ? shortened(name.Scalar()) : std::to_string(index);
    push(list.key + "[" + which + "]", item);
  }

  void checkUnknownKeys() const {
    for (const auto& item : levels_.back().node) {
      const std::string key = item.first.Scalar();
      const auto& known = levels_.back().known;
      if (std::find(known.begin(), known.end(), key) != known.end()) continue;
      throw InputError(place(item.first) + ": unknown key '" + levels_.back().prefix +
                       shortened(key) + "'; the nearest known key is '" + nearestName(key, known) +
                       "' (known here: " + joinText(known, ", ") + ")");
    }
  }

 private:
  /// A group being read: the whole map, or one nested in it.
  struct Level {
    std::string prefix;              ///< "group.subgroup.", before its keys in errors
    YAML::Node node;                 ///< its map
    std::vector<std::string> known;  ///< keys of the fields described so far
  };

  /// A list of groups being read.
  struct List {
    std::string key;
    YAML::Node node;
  };

  void push(const std::string& key, YAML::Node node) {
    const std::string prefix = key.empty() ? "" : levels_.back().prefix + key + ".";
    std::set<std::string> seen;
    for (const auto& item : node) {
      if (!item.first.IsScalar()) {
        throw InputError(place(item.first) + ": a key must be a plain word");
      }
      if (item.first.Scalar().size() > kLongestText)
        throw InputError(place(item.first) + ": a key is longer than any known one");
      if (!seen.insert(item.first.Scalar()).second) {
        throw InputError(place(item.first) + ": key '" + prefix + item.first.Scalar() +
                         "' is given twice");
      }
    }
    levels_.push_back({prefix, node, {}});
  }

  /// The value of a field, and notes that its key is known; an undefined node when not given.
  YAML::Node take(const FieldInfo& info) {
    levels_.back().known.emplace_back(info.key);
    const YAML::Node& level = levels_.back().node;
    const YAML::Node node = level[info.key];
    if (node && node.IsScalar()) requireShort(node, info.key);
    return node;
  }

  void requireShort(const YAML::Node& node, const std::string& key) const {
    if (node.Scalar().size() <= kLongestText) return;
    throw InputError(place(node) + ": key '" + levels_.back().prefix + key + "' is a text of " +
                     std::to_string(node.Scalar().size()) + " bytes; at most " +
                     std::to_string(kLongestText) + " were expected");
  }

  std::string place(const YAML::Node& node) const {
    const YAML::Mark mark = node.Mark();
    return mark.line < 0 || !lines_ ? source_ : source_ + ":" + std::to_string(mark.line + 1);
  }

  [[noreturn]] void fail(const YAML::Node& node, const std::string& key,
                         const std::string& expected) const {
    const std::string given =
        node.IsScalar() ? "'" + shortened(node.Scalar()) + "'" : "not such a value";
    throw InputError(place(node) + ": key '" + levels_.back().prefix + key + "' is " + given +
                     "; expected " + expected);
  }

  Eigen::Vector3d point(const FieldInfo& info, const YAML::Node& item) const {
    const bool sized = item.IsSequence() && (item.size() == 2 || item.size() == 3);
    if (!sized) fail(item, info.key, "points [x, y] or [x, y, z] in meters");
    Eigen::Vector3d result = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < item.size(); ++i) {
      const auto parsed = item[i].IsScalar() ? parseNumber(item[i].Scalar()) : std::nullopt;
      if (!parsed) fail(item[i], info.key, "points of finite numbers in meters");
      result[static_cast<Eigen::Index>(i)] = *parsed;
    }
    return result;
  }

  std::string source_;
  bool lines_;
  std::vector<Level> levels_;
  std::vector<List> lists_;
};

/// `value` as the only leaf below the keys of `path`, as in "a.b=value".
YAML::Node nested(const std::vector<std::string>& path, std::size_t depth,
                  const YAML::Node& value) {
  if (depth == path.size()) return value;
  YAML::Node node(YAML::NodeType::Map);
  node[path[depth]] = nested(path, depth + 1, value);
  return node;
}

}  // namespace

void load(const YamlSource& source, void* options, Describe describe) {
  YAML::Node root = parseYaml(source);
  if (root.IsNull()) root = YAML::Node(YAML::NodeType::Map);
  if (!root.IsMap()) throw InputError(source.name + ":1: expected a map of keys");
  LoadVisitor visitor(source.name, root, true);
  describe(options, visitor);
  visitor.checkUnknownKeys();
}

void override_(const std::string& assignment, const std::string& source, void* options,
               Describe describe) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InputError(source + ": '" + assignment + "' is not of the form key=value");
  }
  const std::string path = resolvePath(assignment.substr(0, equals), source, options, describe);
  const std::string value_text = assignment.substr(equals + 1);
  const YAML::Node value = value_text.empty() ? YAML::Node("") : parseYaml({source, value_text});
  const std::string instead = value.IsMap() ? "" : keysInstead(path, options, describe);
  if (!instead.empty()) {
    throw InputError(source + ": key '" + path + "' is a group of keys and cannot be '" +
                     shortened(value_text) + "'; set one of its keys: " + instead);
  }
  LoadVisitor visitor(source, nested(splitText(path, '.'), 0, value), false);
  describe(options, visitor);
}

}  // namespace cdiff::core::detail

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace cdiff::core {

// Options structs describe their fields once (key, unit, range, sentence); loading, checking,
// overriding and writing them all go through that description, whatever the values come from (YAML
// file, `--set`, ROS parameter).

/// Name, unit and meaning of a field.
struct FieldInfo {
  const char* key;   ///< snake_case key
  const char* unit;  ///< unit, or "" for a plain number or text
  const char* text;  ///< one sentence: meaning
};

/// Visits the fields of an options struct. A struct offers `void describe(OptionsVisitor&
/// visitor)`.
class OptionsVisitor {
 public:
  virtual ~OptionsVisitor() = default;
  /// A number in [minimum, maximum].
  virtual void number(const FieldInfo& info, double& value, double minimum, double maximum) = 0;
  /// A whole number in [minimum, maximum].
  virtual void integer(const FieldInfo& info, std::int64_t& value, std::int64_t minimum,
                       std::int64_t maximum) = 0;
  /// Yes or no.
  virtual void flag(const FieldInfo& info, bool& value) = 0;
  /// A text; when `choices` is not empty, one of them.
  virtual void text(const FieldInfo& info, std::string& value,
                    const std::vector<std::string>& choices) = 0;
  /// A text that may also be given as a list of texts, which `separator` joins.
  virtual void joinedTexts(const FieldInfo& info, std::string& value, char separator);
  /// A list of texts.
  virtual void list(const FieldInfo& info, std::vector<std::string>& value) = 0;
  /// A list of points [x, y] or [x, y, z] in the map frame [m].
  virtual void points(const FieldInfo& info, std::vector<Eigen::Vector3d>& value) = 0;
  /// Enters a nested group, which `leave` ends; returns whether the group is to be visited.
  virtual bool enter(const FieldInfo& info) = 0;
  /// Leaves the group that was entered last.
  virtual void leave() = 0;

  /// Visits a nested options struct under `info.key`.
  template <class Options>
  void group(const FieldInfo& info, Options& options) {
    if (!enter(info)) return;
    options.describe(*this);
    leave();
  }

  /// Visits a list of options structs of one type under `info.key`: in YAML a list of groups, which
  /// replaces what the list held.
  template <class Options>
  void groups(const FieldInfo& info, std::vector<Options>& list) {
    if (const std::optional<std::size_t> given = givenGroups(info)) list.assign(*given, Options());
    if (!enterGroups(info)) return;
    for (std::size_t i = 0; i < list.size(); ++i) {
      enterItem(i);
      list[i].describe(*this);
      leave();
    }
    leaveGroups();
  }

 protected:
  /// How many groups the source gives; nullopt where it does not give the list.
  virtual std::optional<std::size_t> givenGroups(const FieldInfo&) { return std::nullopt; }
  /// Enters a list, which `leaveGroups` ends; returns whether its groups are to be visited.
  virtual bool enterGroups(const FieldInfo&) { return false; }
  /// Leaves the list that was entered last.
  virtual void leaveGroups() {}
  /// Enters a group of the list, which `leave` ends.
  virtual void enterItem(std::size_t) {}
};

/// A YAML text with the name it is known by in errors ("file.yaml", "--set", "parameter ~set").
struct YamlSource {
  std::string name;  ///< in errors
  std::string text;  ///< the YAML
};

namespace detail {
using Describe = void (*)(void* options, OptionsVisitor& visitor);
void load(const YamlSource& source, void* options, Describe describe);
void override_(const std::string& assignment, const std::string& source, void* options,
               Describe describe);
std::string dump(void* options, Describe describe, bool with_comments);
template <class Options>
void describeAs(void* options, OptionsVisitor& visitor) {
  static_cast<Options*>(options)->describe(visitor);
}
}  // namespace detail

/// Reads a YAML map into `options`; keys not given keep their value. Throws InputError with file,
/// line, key, what was expected and the nearest known key for: broken YAML, unknown or repeated
/// key, wrong type, value out of range, more than 8 MiB, a key or value of more than 64 KiB.
template <class Options>
void loadOptions(const YamlSource& source, Options& options) {
  detail::load(source, &options, &detail::describeAs<Options>);
}

/// Applies one "key=value". A nested key is written "group.key"; a leaf name alone will do where it
/// is unique. Throws InputError that names `source`, the key and the nearest known key.
template <class Options>
void overrideOption(const std::string& assignment, const std::string& source, Options& options) {
  detail::override_(assignment, source, &options, &detail::describeAs<Options>);
}

/// The options as YAML that loadOptions reads back to the same values; with a comment above each
/// key if asked.
template <class Options>
std::string dumpOptions(Options options, bool with_comments = false) {
  return detail::dump(&options, &detail::describeAs<Options>, with_comments);
}

}  // namespace cdiff::core

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/options_path.h"

#include <algorithm>
#include <vector>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

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
  void text(const FieldInfo& info, std::string&, const std::vector<std::string>&) override {
    add(info);
  }
  void list(const FieldInfo& info, std::vector<std::string>&) override { add(info); }
  void points(const FieldInfo& info, std::vector<Eigen::Vector3d>&) override { add(info); }
  bool enter(const FieldInfo& info) override {
    add(info);
    prefixes_.push_back(prefix() + info.key + ".");
    return true;
  }
  void leave() override { prefixes_.pop_back(); }

  const std::vector<std::string>& paths() const { return paths_; }

 private:
  std::string prefix() const { return prefixes_.empty() ? "" : prefixes_.back(); }
  void add(const FieldInfo& info) { paths_.push_back(prefix() + info.key); }
  std::vector<std::string> prefixes_;
  std::vector<std::string> paths_;
};

std::string lastPart(const std::string& path) { return path.substr(path.rfind('.') + 1); }

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
  throw InputError(source + ": unknown key '" + key + "'; the nearest known key is '" +
                   nearestName(key, paths) + "'");
}

}  // namespace cdiff::core::detail

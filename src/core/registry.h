// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/spelling.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {

/// Whether `name` is a lower-case letter and then lower-case letters, digits and underscores.
inline bool isSnakeCase(std::string_view name) {
  if (name.empty() || name.front() < 'a' || name.front() > 'z') return false;
  return name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string_view::npos;
}

/// Whether who added an entry is a plug-in.
inline bool isPlugin(std::string_view source) { return source.rfind("plug-in ", 0) == 0; }

/// A table of entries by name, to which plug-ins add while the program runs.
/// Descriptors (a struct with `name`) in the order in which they were added, with who added each.
/// What it holds stays where it is.
template <class Descriptor>
class Registry {
 public:
  /// `kind` names the entries in messages ("planner"); `package` are those of this package.
  Registry(std::string kind, std::vector<Descriptor> package) : kind_(std::move(kind)) {
    for (Descriptor& descriptor : package) add(std::move(descriptor), "package e2e_cdiff");
  }

  /// Throws InputError naming `source` for a name that is not snake_case or is taken.
  void add(Descriptor descriptor, const std::string& source) {
    const std::string what = source + ": " + kind_ + " '" + descriptor.name + "'";
    if (!isSnakeCase(descriptor.name)) throw InputError(what + ": its name must be snake_case");
    if (find(descriptor.name) != nullptr) {
      throw InputError(what + " is already registered by " + sourceOf(descriptor.name) +
                       "; one of the two needs another name");
    }
    entries_.push_back(std::move(descriptor));
    sources_.push_back(source);
  }

  /// nullptr for an unknown name.
  const Descriptor* find(const std::string& name) const {
    const std::size_t index = indexOf(name);
    return index == entries_.size() ? nullptr : &entries_[index];
  }
  /// Throws InputError naming the nearest known one for an unknown name.
  const Descriptor& at(const std::string& name) const {
    if (const Descriptor* found = find(name)) return *found;
    throw InputError("unknown " + kind_ + " '" + name + "'; the nearest known " + kind_ + " is '" +
                     nearestName(name, names()) + "'");
  }
  /// Who added it; "" for an unknown name.
  std::string sourceOf(const std::string& name) const {
    const std::size_t index = indexOf(name);
    return index == entries_.size() ? "" : sources_[index];
  }
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const Descriptor& entry : entries_) all.push_back(entry.name);
    return all;
  }
  const std::deque<Descriptor>& entries() const { return entries_; }

 private:
  /// entries_.size() for an unknown name.
  std::size_t indexOf(const std::string& name) const {
    const auto found = std::find_if(entries_.begin(), entries_.end(),
                                    [&](const Descriptor& each) { return each.name == name; });
    return static_cast<std::size_t>(found - entries_.begin());
  }

  std::string kind_;
  std::deque<Descriptor> entries_;
  std::vector<std::string> sources_;  ///< who added each entry
};

}  // namespace cdiff::core

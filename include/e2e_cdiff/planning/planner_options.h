// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "e2e_cdiff/core/options.h"

namespace cdiff::planning {

/// Options of one planner, whatever their type. In a scenario file they are the group of the
/// planner's name.
class PlannerOptions {
 public:
  virtual ~PlannerOptions() = default;
  /// Visits every option.
  virtual void describe(core::OptionsVisitor& visitor) = 0;
  /// Throws InputError for values that contradict each other.
  virtual void validate() const = 0;
  /// A copy.
  virtual std::unique_ptr<PlannerOptions> clone() const = 0;
};

/// Options held in a struct with `describe` and `validate`.
template <class Options>
class PlannerOptionsOf final : public PlannerOptions {
 public:
  /// Visits every option.
  void describe(core::OptionsVisitor& visitor) override { values.describe(visitor); }
  void validate() const override { values.validate(); }
  /// A copy.
  std::unique_ptr<PlannerOptions> clone() const override {
    return std::make_unique<PlannerOptionsOf>(*this);
  }
  Options values;  ///< the struct
};

/// The options of all planners of a scenario. Copies are deep.
class PlannerOptionsTable {
 public:
  /// A planner's name with a sentence about it, and its options.
  struct Entry {
    std::string name;                         ///< of the planner
    std::string help;                         ///< the sentence
    std::unique_ptr<PlannerOptions> options;  ///< never null
  };

  PlannerOptionsTable() = default;
  /// One entry per planner.
  explicit PlannerOptionsTable(std::vector<Entry> entries) : entries_(std::move(entries)) {}
  PlannerOptionsTable(const PlannerOptionsTable& other);                     ///< deep copy
  PlannerOptionsTable(PlannerOptionsTable&&) noexcept = default;             ///< move
  PlannerOptionsTable& operator=(const PlannerOptionsTable& other);          ///< deep copy
  PlannerOptionsTable& operator=(PlannerOptionsTable&&) noexcept = default;  ///< move

  /// The options of type `Options`; several planners may use those of one. Throws std::logic_error
  /// when no planner has options of this type.
  template <class Options>
  Options& of() {
    for (Entry& entry : entries_) {
      if (auto* found = dynamic_cast<PlannerOptionsOf<Options>*>(entry.options.get()))
        return found->values;
    }
    throw std::logic_error("no planner is registered with these options");
  }
  /// The same, to read.
  template <class Options>
  const Options& of() const {
    return const_cast<PlannerOptionsTable*>(this)->of<Options>();
  }
  /// Visits one group per planner, under its name.
  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError for the first planner whose values contradict each other.
  void validate() const;

 private:
  std::vector<Entry> entries_;
};

/// The usual `options` of a descriptor.
template <class Options>
std::unique_ptr<PlannerOptions> makePlannerOptions() {
  return std::make_unique<PlannerOptionsOf<Options>>();
}

}  // namespace cdiff::planning

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/option_ranges.h"

#include <algorithm>

#include "core/options_path.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core::detail {
namespace {

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

void requireRanges(void* options, Describe describe, const std::string& subject) {
  RangeVisitor visitor(subject);
  describe(options, visitor);
}

}  // namespace cdiff::core::detail

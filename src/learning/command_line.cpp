// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "learning/command_line.h"

#include <algorithm>
#include <cctype>
#include <sstream>

#include "core/text.h"

namespace cdiff::learning {
namespace {

using core::FieldInfo;

std::string optionName(const std::string& key) {
  std::string name = "--" + key;
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

/// "Between two checkpoints [s]".
std::string helpOf(const FieldInfo& info, const std::vector<std::string>& choices = {}) {
  std::string help = info.text;
  if (!help.empty() && help.back() == '.') help.pop_back();
  if (*info.unit != '\0') help += " [" + std::string(info.unit) + "]";
  return choices.empty() ? help : help + " (" + core::joinText(choices, " | ") + ")";
}

/// "Mirror samples" -> "Do not mirror samples".
std::string refusal(std::string help) {
  help.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(help.front())));
  return "Do not " + help;
}

class OptionAdder : public core::OptionsVisitor {
 public:
  OptionAdder(CLI::App& program, Training& training) : program_(program), training_(training) {}

  void number(const FieldInfo& info, double& value, double, double) override {
    std::ostringstream text;
    text << value;
    addChecked(info, helpOf(info), "FLOAT", text.str());
  }
  void integer(const FieldInfo& info, std::int64_t& value, std::int64_t, std::int64_t) override {
    addChecked(info, helpOf(info), "INT", std::to_string(value));
  }
  void text(const FieldInfo& info, std::string& value,
            const std::vector<std::string>& choices) override {
    if (!choices.empty()) return addChecked(info, helpOf(info, choices), "TEXT", value);
    program_.add_option(optionName(info.key), value, helpOf(info))->default_str(value);
  }
  void flag(const FieldInfo& info, bool& value) override {
    const bool normally = value;
    const auto set = [&value, normally](std::int64_t count) {
      value = count > 0 ? !normally : normally;
    };
    if (!normally) program_.add_flag_function(optionName(info.key), set, helpOf(info));
    if (normally)
      program_.add_flag_function(optionName("no-" + std::string(info.key)), set,
                                 refusal(helpOf(info)));
  }
  void list(const FieldInfo& info, std::vector<std::string>& value) override {
    program_.add_option(optionName(info.key), value, helpOf(info))->delimiter(',');
  }
  void points(const FieldInfo&, std::vector<Eigen::Vector3d>&) override {}  // none has any
  bool enter(const FieldInfo&) override { return true; }
  void leave() override {}

 private:
  /// What is given is checked as any other text that sets this key.
  void addChecked(const FieldInfo& info, const std::string& help, const char* type,
                  const std::string& value) {
    const std::string name = optionName(info.key);
    const auto set = [&training = training_, name,
                      key = std::string(info.key)](const std::string& text) {
      core::overrideOption(key + "=" + text, "option " + name, training);
    };
    program_.add_option_function<std::string>(name, set, help)->type_name(type)->default_str(value);
  }

  CLI::App& program_;
  Training& training_;
};

}  // namespace

void addOptions(CLI::App& program, Training& training) {
  OptionAdder adder(program, training);
  training.describe(adder);
}

}  // namespace cdiff::learning

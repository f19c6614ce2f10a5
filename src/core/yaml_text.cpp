// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/yaml_text.h"

#include <yaml-cpp/depthguard.h>

#include <algorithm>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {

std::string yamlQuoted(const std::string& text) {
  YAML::Emitter emitter;
  emitter << YAML::DoubleQuoted << text;
  return emitter.c_str();
}

}  // namespace cdiff::core

namespace cdiff::core::detail {
namespace {

constexpr std::size_t kLargestYaml = 8 << 20;  // [bytes]

/// Refuses a text with a NUL byte, unless it starts with the byte order mark of UTF-16 or UTF-32,
/// in which YAML may be written.
void requireText(const YamlSource& source) {
  const std::size_t place = source.text.find('\0');
  if (place == std::string::npos) return;
  for (const std::string& mark :
       {std::string("\xFF\xFE"), std::string("\xFE\xFF"), std::string("\0\0\xFE\xFF", 4)}) {
    if (source.text.compare(0, mark.size(), mark) == 0) return;
  }
  const auto end = source.text.begin() + static_cast<std::ptrdiff_t>(place);
  const auto line = 1 + std::count(source.text.begin(), end, '\n');
  throw InputError(source.name + ":" + std::to_string(line) +
                   ": holds a NUL byte, which no text has; expected YAML in UTF-8");
}

}  // namespace

YAML::Node parseYaml(const YamlSource& source) {
  if (source.text.size() > kLargestYaml) {
    throw InputError(source.name + ": holds " + std::to_string(source.text.size()) +
                     " bytes of YAML; at most " + std::to_string(kLargestYaml) + " were expected");
  }
  requireText(source);
  try {
    return YAML::Load(source.text);
  } catch (const YAML::DeepRecursion& error) {
    throw InputError(source.name + ":" + std::to_string(error.mark.line + 1) +
                     ": lists or groups are nested deeper than any option");
  } catch (const YAML::ParserException& error) {
    throw InputError(source.name + ":" + std::to_string(error.mark.line + 1) +
                     ": not valid YAML: " + error.msg);
  }
}

}  // namespace cdiff::core::detail

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

#include "e2e_cdiff/core/options.h"

namespace cdiff::core {

/// A text in YAML's double quotes, which reads as that text whatever it holds.
std::string yamlQuoted(const std::string& text);

}  // namespace cdiff::core

namespace cdiff::core::detail {

/// The tree of a YAML text. Throws InputError naming source and line for a text of more than 8 MiB,
/// with a NUL byte, nested too deeply, or that is no YAML.
YAML::Node parseYaml(const YamlSource& source);

}  // namespace cdiff::core::detail

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/json_file.h"

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {

void requireShallowJson(std::string_view text, const std::string& source) {
  constexpr int kDeepest = 100;
  int depth = 0;
  bool inside = false;  // a string
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char letter = text[i];
    if (letter == '"') inside = !inside;
    if (inside && letter == '\\') ++i;  // the next letter does not end the string
    if (inside) continue;
    if (letter == '[' || letter == '{') ++depth;
    if (letter == ']' || letter == '}') --depth;
    if (depth > kDeepest)
      throw InputError(source + ": its JSON nests deeper than " + std::to_string(kDeepest) +
                       " brackets; expected a file as this program writes it");
  }
}

nlohmann::json readJson(const std::filesystem::path& file, const std::string& what) {
  const std::string text = readFile(file, what);
  requireShallowJson(text, what + " '" + file.string() + "'");
  return nlohmann::json::parse(text);
}

std::string jsonFault(const std::exception& error) {
  constexpr std::size_t kMostBytes = 300;  // it may quote the text
  const std::string text = error.what();
  const std::size_t end = text.find("] ");  // of "[json.exception.type_error.302]"
  return shortened(end == std::string::npos ? text : text.substr(end + 2), kMostBytes);
}

}  // namespace cdiff::core

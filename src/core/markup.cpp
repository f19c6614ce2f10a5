// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/markup.h"

#include <cmath>

#include "core/text.h"

namespace cdiff::core {
namespace {

constexpr const char* kReplacement = "\xEF\xBF\xBD";  // U+FFFD

/// Bytes of the UTF-8 sequence that begins the text; 0 when it is not a valid one.
std::size_t sequenceLength(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text.front());
  const std::size_t length = lead < 0x80                   ? 1
                             : lead >= 0xC2 && lead < 0xE0 ? 2
                             : (lead & 0xF0) == 0xE0       ? 3
                             : lead >= 0xF0 && lead < 0xF5 ? 4
                                                           : 0;
  if (length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((static_cast<unsigned char>(text[i]) & 0xC0) != 0x80) return 0;
  }
  if (length < 3) return length;
  const auto second = static_cast<unsigned char>(text[1]);
  const bool overlong = (lead == 0xE0 && second < 0xA0) || (lead == 0xF0 && second < 0x90);
  const bool outside = (lead == 0xED && second >= 0xA0) || (lead == 0xF4 && second >= 0x90);
  return overlong || outside ? 0 : length;
}

void appendAscii(std::string& escaped, char letter) {
  switch (letter) {
    case '&':
      escaped += "&amp;";
      return;
    case '<':
      escaped += "&lt;";
      return;
    case '>':
      escaped += "&gt;";
      return;
    case '"':
      escaped += "&quot;";
      return;
    case '\'':
      escaped += "&#39;";
      return;
    default:
      break;
  }
  const bool forbidden =
      (letter >= 0 && letter < 0x20 && letter != '\t' && letter != '\n') || letter == 0x7F;
  if (forbidden) {
    escaped += kReplacement;
  } else {
    escaped += letter;
  }
}

}  // namespace

std::string escapeMarkup(std::string_view text) {
  std::string escaped;
  escaped.reserve(text.size() + 16);
  while (!text.empty()) {
    const std::size_t length = sequenceLength(text);
    if (length == 1) appendAscii(escaped, text.front());
    if (length == 0) escaped += kReplacement;
    if (length > 1) escaped += text.substr(0, length);
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return escaped;
}

std::string shortNumber(double value) {
  const double rounded = std::round(value * 10.0) / 10.0;
  return core::formatNumber(rounded == 0.0 ? 0.0 : rounded);
}

}  // namespace cdiff::core

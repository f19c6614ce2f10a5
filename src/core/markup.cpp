// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/markup.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/text.h"

namespace cdiff::core {
namespace {

constexpr const char* kReplacement = "\xEF\xBF\xBD";  // U+FFFD

/// Bytes of the UTF-8 sequence that starts the text; 0 when it is not a valid one.
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

/// Whether a character (one UTF-8 sequence) may be shown as it is.
bool isShown(std::string_view letter) {
  const auto byte = [letter](std::size_t i) { return static_cast<unsigned char>(letter[i]); };
  if (letter.size() == 1)
    return (byte(0) >= 0x20 && byte(0) != 0x7F) || byte(0) == '\t' || byte(0) == '\n';
  if (letter.size() == 2) return byte(0) != 0xC2 || byte(1) >= 0xA0;  // U+0080 to U+009F
  if (letter.size() == 4) return true;
  const bool embedding = byte(0) == 0xE2 && byte(1) == 0x80 && byte(2) >= 0xAA && byte(2) <= 0xAE;
  const bool isolate = byte(0) == 0xE2 && byte(1) == 0x81 && byte(2) >= 0xA6 && byte(2) <= 0xA9;
  const bool no_character = byte(0) == 0xEF && byte(1) == 0xBF && byte(2) >= 0xBE;
  return !embedding && !isolate && !no_character;
}

/// Removes the first character of `text` and answers it as it is shown.
std::string_view takeLetter(std::string_view& text) {
  const std::size_t length = sequenceLength(text);
  const std::string_view letter = text.substr(0, length);
  text.remove_prefix(std::max<std::size_t>(1, length));
  return length > 0 && isShown(letter) ? letter : kReplacement;
}

std::string escaped(std::string_view text) {
  constexpr std::pair<char, const char*> kEntities[] = {
      {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}};
  std::string result;
  result.reserve(text.size() + 16);
  while (!text.empty()) {
    const std::string_view letter = takeLetter(text);
    const auto entity = std::find_if(
        std::begin(kEntities), std::end(kEntities),
        [letter](const auto& pair) { return letter.size() == 1 && pair.first == letter.front(); });
    result += entity == std::end(kEntities) ? letter : entity->second;
  }
  return result;
}

bool isOneOf(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

std::string plainText(std::string_view text) {
  std::string plain;
  plain.reserve(text.size());
  while (!text.empty()) plain += takeLetter(text);
  return plain;
}

std::string cutText(std::string_view text, std::size_t letters) {
  std::string cut;
  std::string last;
  for (std::size_t i = 0; i < letters && !text.empty(); ++i) {
    cut += last;
    last = takeLetter(text);
  }
  return cut + (text.empty() || letters == 0 ? last : "…");
}

std::string shortNumber(double value) {
  const double rounded = std::round(value * 10.0) / 10.0;
  return core::formatNumber(rounded == 0.0 ? 0.0 : rounded);
}

Attribute flag(const char* name) {
  Attribute attribute(name, "");
  attribute.flag = true;
  return attribute;
}

Markup::Markup(const char* text) : markup_(escaped(text)) {}

Markup::Markup(const std::string& text) : markup_(escaped(text)) {}

Markup& Markup::operator+=(const Markup& other) {
  markup_ += other.markup_;
  return *this;
}

Markup operator+(Markup left, const Markup& right) {
  left += right;
  return left;
}

Markup element(const char* name, const std::vector<Attribute>& attributes, const Markup& content) {
  Markup written;
  std::string& text = written.markup_;
  text.reserve(content.markup_.size() + 64);
  text = "<" + std::string(name);
  for (const Attribute& attribute : attributes) {
    text += " " + std::string(attribute.name);
    if (!attribute.flag) text += "=\"" + escaped(attribute.value) + "\"";
  }
  if (isOneOf(name, {"img", "input", "meta"})) {
    text += ">";
  } else if (content.empty() && isOneOf(name, {"path", "circle", "rect"})) {
    text += "/>";
  } else {
    ((text += ">") += content.markup_) += "</" + std::string(name) + ">";
  }
  return written;
}

Markup styleElement(const std::vector<const Asset*>& sheets) {
  Markup written;
  written.markup_ = "<style>\n";
  for (const Asset* sheet : sheets) written.markup_ += sheet->text();
  written.markup_ += "</style>\n";
  return written;
}

Markup scriptElement(const Asset& script) {
  Markup written;
  (written.markup_ = "<script>\n") += script.text();
  written.markup_ += "</script>\n";
  return written;
}

Markup jsonElement(const std::string& id, std::string_view json) {
  Markup written;
  written.markup_ = "<script type=\"application/json\" id=\"" + escaped(id) + "\">";
  for (const char letter : plainText(json)) {
    if (letter == '<') {
      written.markup_ += "\\u003c";
    } else {
      written.markup_ += letter;
    }
  }
  written.markup_ += "</script>\n";
  return written;
}

std::string markdownText(std::string_view text) {
  std::string marked;
  for (const char letter : plainText(text)) {
    if (letter == '<') {
      marked += "&lt;";
    } else if (letter == '|' || letter == '[') {
      (marked += '\\') += letter;
    } else {
      marked += letter == '\n' || letter == '\t' ? ' ' : letter;
    }
  }
  return marked;
}

std::string htmlDocument(const Markup& head, const Markup& body) {
  const Markup html = element("html", {{"lang", "en"}}, "\n" + head + "\n" + body + "\n");
  return "<!DOCTYPE html>\n" + html.str() + "\n";
}

std::string xmlDocument(const Markup& root) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + root.str() + "\n";
}

}  // namespace cdiff::core

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace cdiff::core {

/// `text` (UTF-8) made safe to show: U+FFFD replaces control characters (except tab and line feed),
/// U+FFFE and U+FFFF, bytes that are not UTF-8, and marks that change the direction of the text
/// (U+202A to U+202E, U+2066 to U+2069).
std::string plainText(std::string_view text);

/// `plainText(text)` cut to at most `letters` characters, of which the last is then "…".
std::string cutText(std::string_view text, std::size_t letters);

/// `value` with at most one decimal ("12", "12.3"), for coordinates in SVG.
std::string shortNumber(double value);

/// Name and value of an attribute; the value is escaped when it is written.
struct Attribute {
  Attribute(const char* a_name, const char* a_value) : name(a_name), value(a_value) {}
  Attribute(const char* a_name, std::string a_value) : name(a_name), value(std::move(a_value)) {}
  /// A number, written with at most one decimal.
  template <class Number, class = std::enable_if_t<std::is_arithmetic_v<Number>>>
  Attribute(const char* a_name, Number a_value)
      : name(a_name), value(shortNumber(static_cast<double>(a_value))) {}

  const char* name;
  std::string value;
  bool flag = false;  ///< written as its name alone
};

/// An attribute without a value, such as "hidden".
Attribute flag(const char* name);

/// The content of a file of the source tree (style sheet, script), which the build embeds in the
/// library (cmake/CdiffAssets.cmake).
class Asset {
 public:
  template <std::size_t N>
  explicit constexpr Asset(const unsigned char (&bytes)[N]) : bytes_(bytes), size_(N) {}
  std::string_view text() const { return {reinterpret_cast<const char*>(bytes_), size_}; }

 private:
  const unsigned char* bytes_;
  std::size_t size_;
};

/// A piece of HTML, SVG or XML, built so that no text in it can break it: elements are made by the
/// functions below alone, and a text that is converted to Markup is made plain (`plainText`) and
/// has its & < > " ' escaped. Used by the report, the pages of batches and training, and the
/// figures.
class Markup {
 public:
  Markup() = default;
  Markup(const char* text);  // NOLINT(google-explicit-constructor): any text may stand where markup
                             // is expected
  Markup(const std::string& text);  // NOLINT(google-explicit-constructor)

  Markup& operator+=(const Markup& other);
  bool empty() const { return markup_.empty(); }
  /// The finished text, for a file or a test. Do not convert it to Markup: it would be escaped
  /// again.
  const std::string& str() const { return markup_; }

 private:
  friend Markup element(const char*, const std::vector<Attribute>&, const Markup&);
  friend Markup styleElement(const std::vector<const Asset*>&);
  friend Markup scriptElement(const Asset&);
  friend Markup jsonElement(const std::string&, std::string_view);
  std::string markup_;
};

Markup operator+(Markup left, const Markup& right);

/// `<name attributes>content</name>`. Void elements such as `<img ...>` get no end tag; a path,
/// circle or rect without content is self-closing.
Markup element(const char* name, const std::vector<Attribute>& attributes = {},
               const Markup& content = {});

/// A `<style>` with the sheets in this order, which must not contain & or <, so that the element is
/// valid in HTML and in XML.
Markup styleElement(const std::vector<const Asset*>& sheets);

/// A `<script>`, whose text must not contain "</script".
Markup scriptElement(const Asset& script);

/// A `<script type="application/json">`; every < of the JSON text becomes \u003c.
Markup jsonElement(const std::string& id, std::string_view json);

/// `plainText(text)` for a cell or a heading of a Markdown page: on one line, without < and with |
/// and [ escaped, so that it starts no HTML, link or further cell.
std::string markdownText(std::string_view text);

/// Whole files: HTML or XML with its declaration.
std::string htmlDocument(const Markup& head, const Markup& body);
std::string xmlDocument(const Markup& root);

}  // namespace cdiff::core

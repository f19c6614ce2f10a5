// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/page_parts.h"

#include <cctype>
#include <cstdlib>
#include <regex>

#include "core/text.h"

namespace cdiff::page {
namespace {

using Attributes = std::vector<core::Attribute>;

const char* signOf(record::Outcome outcome) {
  if (outcome == record::Outcome::kPassed) return "✓";
  if (outcome == record::Outcome::kFailed) return "✗";
  return outcome == record::Outcome::kNotJudged ? "–" : "!";
}

/// "What happened" is "what-happened": letters and digits of a title, the rest one hyphen.
std::string idOf(const std::string& title) {
  std::string id;
  for (const char letter : title) {
    const auto code = static_cast<unsigned char>(letter);
    if (std::isalnum(code) != 0)
      id += static_cast<char>(std::tolower(code));
    else if (!id.empty() && id.back() != '-')
      id += '-';
  }
  return id;
}

/// The attribute class, where there is one.
Attributes classOf(const std::string& style) {
  return style.empty() ? Attributes() : Attributes{{"class", style}};
}

}  // namespace

std::string pageDocument(const std::string& title, const std::vector<const core::Asset*>& styles,
                         const Markup& content, const Markup& end) {
  std::vector<const core::Asset*> sheets = {&kReportStyle};
  sheets.insert(sheets.end(), styles.begin(), styles.end());
  const Markup head =
      "\n" + element("meta", {{"charset", "utf-8"}}) + "\n" +
      element("meta", {{"name", "viewport"}, {"content", "width=device-width, initial-scale=1"}}) +
      "\n" + element("meta", {{"name", "color-scheme"}, {"content", "light dark"}}) + "\n" +
      element("title", {}, title) + "\n" + core::styleElement(sheets);
  const Markup body = "\n" + element("main", {}, "\n" + content) + "\n" + end;
  return core::htmlDocument(element("head", {}, head), element("body", {}, body));
}

Markup pageHeader(const std::string& title, const std::string& line, const Markup& rest) {
  const Markup text = element("h1", {}, title) + "\n" + element("p", {{"class", "sub"}}, line);
  return element("header", {}, "\n" + text + "\n" + rest) + "\n";
}

Markup pageSection(const std::string& title, const Markup& content, const std::string& style) {
  const Markup heading = element("h2", {}, title);
  Attributes attributes = classOf(style);
  attributes.emplace_back("id", idOf(title));
  return element("section", attributes, "\n" + heading + "\n" + content) + "\n";
}

Markup pageContents(const std::vector<PageSection>& sections) {
  Markup links;
  for (const PageSection& section : sections)
    links += element("a", {{"href", "#" + idOf(section.title)}}, section.title) + "\n";
  return element("nav", {{"class", "contents"}, {"aria-label", "Contents"}}, "\n" + links) + "\n";
}

Markup pageSections(const std::vector<PageSection>& sections) {
  Markup html;
  for (const PageSection& section : sections) html += pageSection(section.title, section.content);
  return html;
}

Markup pageBanner(record::Outcome outcome, const std::string& headline, const Markup& content) {
  const Markup sign =
      element("span", {{"class", "sign"}, {"aria-hidden", "true"}}, signOf(outcome));
  const Markup text = element("div", {}, element("strong", {}, headline) + content);
  const std::string style = std::string("banner ") + record::toText(outcome);
  return element("div", {{"class", style}, {"role", "status"}}, sign + text) + "\n";
}

Markup pageNote(const std::string& text) { return element("p", {{"class", "note"}}, text) + "\n"; }

Markup timeLink(double seconds) {
  const std::string text = core::formatFixed(seconds, 2);
  return element("a", {{"class", "time"}, {"href", "#t=" + text}}, text);
}

Markup linkedTimes(const std::string& text) {
  static const std::regex kTime("\\bat ([0-9]{1,6}\\.[0-9]{1,2}) s\\b");
  Markup html;
  auto from = text.cbegin();
  for (std::sregex_iterator found(text.begin(), text.end(), kTime), end; found != end; ++found) {
    const auto at = text.cbegin() + found->position(1);
    html += std::string(from, at) + timeLink(std::strtod(found->str(1).c_str(), nullptr));
    from = at + found->length(1);
  }
  return html + std::string(from, text.cend());
}

Markup pageFold(const Markup& summary, const Markup& content, const std::string& style) {
  return element("details", classOf(style), element("summary", {}, summary) + content) + "\n";
}

Markup legendItem(const Markup& picture, const std::string& text) {
  const Markup sign = element("svg", {{"viewBox", "0 0 28 14"}, {"aria-hidden", "true"}}, picture);
  return element("span", {{"class", "item"}}, sign + text) + "\n";
}

Markup legendLine(const std::string& style, const std::string& text) {
  return legendItem(element("path", {{"class", style}, {"d", "M1 7H27"}}), text);
}

Markup pageLegend(const Markup& items) {
  return element("p", {{"class", "legend"}}, "\n" + items) + "\n";
}

HtmlTable::HtmlTable(const std::vector<std::string>& head) {
  for (const std::string& name : head) {
    const bool number = name.rfind('#', 0) == 0;
    numeric_.push_back(number);
    Attributes attributes = {{"scope", "col"}};
    if (number) attributes.emplace_back("class", "number");
    head_ += element("th", attributes, number ? name.substr(1) : name);
  }
}

void HtmlTable::row(const std::vector<Markup>& cells, const std::string& style) {
  Markup html;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool number = i < numeric_.size() && numeric_[i];
    html += element("td", classOf(number ? "number" : ""), cells[i]);
  }
  rows_ += element("tr", classOf(style), html) + "\n";
}

Markup HtmlTable::html() const {
  const Markup head = head_.empty() ? head_ : element("thead", {}, element("tr", {}, head_));
  const Markup table = element("table", {}, head + element("tbody", {}, "\n" + rows_));
  return element("div", {{"class", "scroll"}}, table) + "\n";
}

}  // namespace cdiff::page

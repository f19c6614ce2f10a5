// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/page_head.h"

#include "core/markup.h"
#include "page/report_style.h"

namespace cdiff::page {
namespace {

const char* signOf(record::Outcome outcome) {
  if (outcome == record::Outcome::kPassed) return "✓";
  if (outcome == record::Outcome::kFailed) return "✗";
  return outcome == record::Outcome::kNotJudged ? "–" : "!";
}

}  // namespace

std::string pageHead(const std::string& title, const std::string& style) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta "
         "name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta "
         "name=\"color-scheme\" content=\"light dark\">\n<title>" +
         core::escapeMarkup(title) + "</title>\n<style>" + kReportStyleSheet + style +
         "</style>\n</head>\n";
}

std::string pageSection(const std::string& title, const std::string& content,
                        const std::string& style) {
  return "<section" + (style.empty() ? "" : " class=\"" + style + "\"") + ">\n<h2>" +
         core::escapeMarkup(title) + "</h2>\n" + content + "</section>\n";
}

std::string pageBanner(record::Outcome outcome, const std::string& headline,
                       const std::string& content) {
  return "<div class=\"banner " + std::string(record::toText(outcome)) +
         "\" role=\"status\"><span class=\"sign\" aria-hidden=\"true\">" + signOf(outcome) +
         "</span><div><strong>" + headline + "</strong>" + content + "</div></div>\n";
}

}  // namespace cdiff::page

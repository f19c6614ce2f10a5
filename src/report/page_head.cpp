// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/report/page_head.h"

#include "e2e_cdiff/report/markup.h"
#include "e2e_cdiff/report/report_style.h"

namespace cdiff::report {
namespace {

const char* signOf(Outcome outcome) {
  if (outcome == Outcome::kPassed) return "✓";
  if (outcome == Outcome::kFailed) return "✗";
  return outcome == Outcome::kNotJudged ? "–" : "!";
}

}  // namespace

std::string pageHead(const std::string& title, const std::string& style) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta "
         "name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta "
         "name=\"color-scheme\" content=\"light dark\">\n<title>" +
         escapeMarkup(title) + "</title>\n<style>" + kReportStyleSheet + style +
         "</style>\n</head>\n";
}

std::string pageSection(const std::string& title, const std::string& content,
                        const std::string& style) {
  return "<section" + (style.empty() ? "" : " class=\"" + style + "\"") + ">\n<h2>" +
         escapeMarkup(title) + "</h2>\n" + content + "</section>\n";
}

std::string pageBanner(Outcome outcome, const std::string& headline, const std::string& content) {
  return "<div class=\"banner " + std::string(toText(outcome)) +
         "\" role=\"status\"><span class=\"sign\" aria-hidden=\"true\">" + signOf(outcome) +
         "</span><div><strong>" + headline + "</strong>" + content + "</div></div>\n";
}

}  // namespace cdiff::report

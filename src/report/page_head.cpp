// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/report/page_head.h"

#include "e2e_cdiff/report/markup.h"
#include "e2e_cdiff/report/report_style.h"

namespace cdiff::report {

std::string pageHead(const std::string& title, const std::string& style) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta "
         "name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta "
         "name=\"color-scheme\" content=\"light dark\">\n<title>" +
         escapeMarkup(title) + "</title>\n<style>" + kReportStyleSheet + style +
         "</style>\n</head>\n";
}

}  // namespace cdiff::report

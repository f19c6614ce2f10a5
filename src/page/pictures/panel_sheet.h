// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/markup.h"

namespace cdiff::page {

/// One picture of a sheet: a title above SVG content [pixels].
struct Panel {
  std::string title;
  core::Markup content;  ///< in pixels of the panel
  double width = 540.0;
  double height = 190.0;
  bool cut = false;  ///< whether what lies outside is cut off
};

/// Pictures side by side under one title as one SVG element, in fixed light colors: a figure for
/// print (pixels, x right, y down).
struct PanelSheet {
  std::string title;
  std::vector<std::pair<std::string, std::string>> legend = {};  ///< (CSS class of a line, text)
  std::vector<std::vector<Panel>> rows = {};                     ///< panels from left to right
  std::vector<std::string> notes = {};                           ///< a paragraph each
};

/// For a page that holds kPanelSheetStyle (page/page_parts.h).
core::Markup sheetSvg(const PanelSheet& sheet);

/// Text of a file of its own.
std::string sheetFile(const PanelSheet& sheet);

/// CSS classes of lines and bars that belong together, for the i-th system.
std::string systemStyle(std::size_t index);

}  // namespace cdiff::page

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/pictures/camera_strip.h"

#include "record/logs/cbv_log.h"

namespace cdiff::page {

using core::element;
using core::Markup;

Markup cameraStrip(const std::vector<session::SlotImage>& views, const std::string& who) {
  if (views.empty()) return {};
  Markup figures;
  for (const session::SlotImage& view : views) {
    const Markup picture = element("img", {{"width", view.image.width},
                                           {"height", view.image.height},
                                           {"alt", "camera " + view.camera + " of the " + who},
                                           {"src", record::pngDataUri(view.image)}});
    figures += element("figure", {{"class", "view small"}},
                       picture + element("figcaption", {}, view.camera)) +
               "\n";
  }
  const std::string line = "What the planner of the " + who + " saw through its " +
                           std::to_string(views.size()) + " cameras";
  return element("p", {{"class", "sub"}}, line) + "\n" +
         element("div", {{"class", "camera-strip"}}, "\n" + figures) + "\n";
}

}  // namespace cdiff::page

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>

#include "rendering/canvas.h"

namespace cdiff::rendering {
namespace {

/// The value that occurs most often; of several the largest. Sorts `values`.
std::uint32_t commonest(std::vector<std::uint32_t>& values) {
  std::sort(values.begin(), values.end());
  std::uint32_t best = values.front();
  std::ptrdiff_t most = 0;
  for (auto from = values.begin(); from != values.end();) {
    const auto to = std::upper_bound(from, values.end(), *from);
    if (to - from >= most) best = *from;
    most = std::max(most, to - from);
    from = to;
  }
  return best;
}

}  // namespace

/// Before the span is painted, with the same depths. What lets more than half of the light through
/// leaves the label as it was.
void Canvas::labelSpan(const Span& span, const Paint& paint) {
  if (paint.opacity < 0.5) return;
  const std::uint32_t label = packedLabel(paint.label);
  for (int i = span.first; i <= span.last; ++i) {
    const std::size_t at = span.offset + static_cast<std::size_t>(i);
    if (span.depthAt(i) > target_->depths[at]) target_->labels[at] = label;
  }
}

void Canvas::readLabels(RenderedView& view) const {
  const auto pixels = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  view.classes.resize(pixels);
  view.instances.resize(pixels);
  for (int row = 0; row < rows_; ++row) startRow(row);
  std::vector<std::uint32_t> here;
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    const int x = static_cast<int>(pixel) % width_ * samples_;
    const int y = static_cast<int>(pixel) / width_ * samples_;
    here.clear();
    for (int row = y; row < y + samples_; ++row) {
      const auto begin = target_->labels.begin() + static_cast<std::ptrdiff_t>(row) * columns_ + x;
      here.insert(here.end(), begin, begin + samples_);
    }
    const std::uint32_t label = commonest(here);
    view.classes[pixel] = static_cast<SceneClass>(label >> 16);
    view.instances[pixel] = static_cast<std::uint16_t>(label & 0xffffu);
  }
}

}  // namespace cdiff::rendering

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <algorithm>
#include <cstring>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "rendering/canvas.h"

namespace cdiff::rendering {
namespace {

/// Sums of colors, two at a time: red and blue, and green, in lanes of 16 bits.
class ColorSums {
 public:
  void add(const Color* pair) {
    std::uint64_t colors;
    std::memcpy(&colors, pair, sizeof(colors));
    red_blue_ += colors & kLanes;
    green_ += (colors >> 8) & kLanes;
  }
  void addOne(Color color) {
    red_blue_ += color & kLanes;
    green_ += (color >> 8) & kLanes;
  }
  /// The rounded means of `kCount` colors as three bytes.
  template <std::uint32_t kCount>
  void writeMean(std::uint8_t* target) const {
    const auto red_blue = static_cast<std::uint32_t>(red_blue_ + (red_blue_ >> 32));
    const auto green = static_cast<std::uint32_t>(green_ + (green_ >> 32));
    target[0] = static_cast<std::uint8_t>(((red_blue & 0xffffu) + kCount / 2) / kCount);
    target[1] = static_cast<std::uint8_t>(((green & 0xffffu) + kCount / 2) / kCount);
    target[2] = static_cast<std::uint8_t>(((red_blue >> 16) + kCount / 2) / kCount);
  }

 private:
  static constexpr std::uint64_t kLanes = 0x00ff00ff00ff00ffu;
  std::uint64_t red_blue_ = 0;
  std::uint64_t green_ = 0;
};

/// Writes a row of pixels, each the rounded mean of the samples in a square of `kSamples` x
/// `kSamples` in the rows that begin at `source`.
template <int kSamples>
void writeMeans(const Color* source, int columns, std::uint8_t* target) {
  for (int x = 0; x < columns; x += kSamples, target += 3) {
    ColorSums sums;
    for (int row = 0; row < kSamples; ++row) {
      const Color* samples = source + static_cast<std::ptrdiff_t>(row) * columns + x;
      for (int i = 0; i + 1 < kSamples; i += 2) sums.add(samples + i);
      if (kSamples % 2 == 1) sums.addOne(samples[kSamples - 1]);
    }
    sums.writeMean<kSamples * kSamples>(target);
  }
}

#ifdef __SSE2__
/// The same for 2 x 2 samples, two pixels at a time: sums in lanes of 16 bits.
template <>
void writeMeans<2>(const Color* source, int columns, std::uint8_t* target) {
  const __m128i zero = _mm_setzero_si128();
  const __m128i half = _mm_set1_epi16(2);
  int x = 0;
  for (; x + 4 < columns; x += 4, target += 6) {  // the last pixels are left: 8 bytes are written
    const __m128i upper = _mm_loadu_si128(reinterpret_cast<const __m128i*>(source + x));
    const __m128i lower = _mm_loadu_si128(reinterpret_cast<const __m128i*>(source + columns + x));
    const __m128i first =
        _mm_add_epi16(_mm_unpacklo_epi8(upper, zero), _mm_unpacklo_epi8(lower, zero));
    const __m128i second =
        _mm_add_epi16(_mm_unpackhi_epi8(upper, zero), _mm_unpackhi_epi8(lower, zero));
    const __m128i sums =
        _mm_add_epi16(_mm_unpacklo_epi64(first, second), _mm_unpackhi_epi64(first, second));
    const __m128i means = _mm_srli_epi16(_mm_add_epi16(sums, half), 2);
    const __m128i bytes = _mm_packus_epi16(means, means);
    const auto pair = static_cast<std::uint64_t>(_mm_cvtsi128_si64(bytes));
    const std::uint64_t packed = (pair & 0xffffffu) | ((pair >> 8) & 0xffffff000000u);
    std::memcpy(target, &packed, sizeof(packed));
  }
  for (; x < columns; x += 2, target += 3) {
    ColorSums sums;
    sums.add(source + x);
    sums.add(source + columns + x);
    sums.writeMean<4>(target);
  }
}
#endif

using WriteMeans = void (*)(const Color*, int, std::uint8_t*);

/// By samples per pixel and axis, from 1 on.
constexpr WriteMeans kWriteMeans[] = {writeMeans<1>, writeMeans<2>, writeMeans<3>, writeMeans<4>,
                                      writeMeans<5>, writeMeans<6>, writeMeans<7>, writeMeans<8>};

}  // namespace

void Canvas::clear(bool labels) {
  const auto samples = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  const auto rows = static_cast<std::size_t>(rows_);
  target_->colors.resize(samples);
  target_->depths.resize(samples);
  target_->labels.resize(labels ? samples : 0);
  target_->span_begin.resize(rows);
  target_->span_end.resize(rows);
  target_->drawn.assign(rows, 0);
}

void Canvas::fillRow(int row) const {
  const auto at = static_cast<std::size_t>(row);
  const auto offset = static_cast<std::ptrdiff_t>(row) * columns_;
  std::fill_n(target_->colors.begin() + offset, columns_, background_[at]);
  std::fill_n(target_->depths.begin() + offset, columns_, 0.0f);
  if (!target_->labels.empty()) {
    std::fill_n(target_->labels.begin() + offset, columns_,
                packedLabel({background_classes_[at], 0}));
  }
  target_->drawn[at] = 1;
}

/// A row of pixels without anything in front of the background has one color.
void Canvas::writeBackground(int y, std::uint8_t* target) const {
  Color samples[64];
  for (int i = 0; i < samples_ * samples_; ++i)
    samples[i] = background_[static_cast<std::size_t>(y * samples_ + i / samples_)];
  kWriteMeans[samples_ - 1](samples, samples_, target);
  for (int done = 3; done < 3 * width_;) {  // doubles what is there
    const int more = std::min(done, 3 * width_ - done);
    std::memcpy(target + done, target, static_cast<std::size_t>(more));
    done += more;
  }
}

traffic::CameraImage Canvas::image() const {
  traffic::CameraImage image;
  image.width = width_;
  image.height = height_;
  image.rgb.resize(3 * static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (int y = 0; y < height_; ++y) {
    std::uint8_t* target = image.rgb.data() + std::ptrdiff_t{3} * y * width_;
    const auto drawn = target_->drawn.begin() + static_cast<std::ptrdiff_t>(y) * samples_;
    if (std::count(drawn, drawn + samples_, 0) == samples_) {
      writeBackground(y, target);
      continue;
    }
    for (int row = y * samples_; row < (y + 1) * samples_; ++row) startRow(row);
    kWriteMeans[samples_ - 1](
        target_->colors.data() + static_cast<std::ptrdiff_t>(y) * samples_ * columns_, columns_,
        target);
  }
  return image;
}

}  // namespace cdiff::rendering

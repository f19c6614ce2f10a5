// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "rendering/canvas.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "e2e_cdiff/core/angle.h"

namespace cdiff::rendering {
namespace {

constexpr double kThinnest = 0.5;   // [samples] half the width of a drawn line
constexpr double kShortest = 1e-6;  // [samples] shorter lines are left out
constexpr double kFaintest = 0.02;  // less opaque lines are left out
constexpr double kEdgeOn = 1e-9;    // [m] planes nearer to the eye are seen edge-on: left out
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Normal of a polygon (optical frame), twice its area long (Newell).
Eigen::Vector3d normalOf(const Eigen::Vector3d* points, int count) {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (int i = 1; i + 1 < count; ++i) {
    normal += (points[i] - points[0]).cross(points[i + 1] - points[0]);
  }
  return normal;
}

/// Where the line between two points meets the near plane; the same in whatever order they come.
Eigen::Vector3d nearCrossing(const Eigen::Vector3d& first, const Eigen::Vector3d& second) {
  const Eigen::Vector3d& behind = first.z() < second.z() ? first : second;
  const Eigen::Vector3d& ahead = first.z() < second.z() ? second : first;
  const double share = (kNearPlane - behind.z()) / (ahead.z() - behind.z());
  Eigen::Vector3d crossing = behind + share * (ahead - behind);
  crossing.z() = kNearPlane;
  return crossing;
}

/// Clips a polygon at the near plane (Sutherland-Hodgman); returns the number of corners in `kept`.
int clipNear(const Eigen::Vector3d* points, int count, Eigen::Vector3d* kept) {
  int corners = 0;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d& here = points[i];
    const Eigen::Vector3d& next = points[i + 1 == count ? 0 : i + 1];
    const bool here_ahead = here.z() >= kNearPlane;
    if (here_ahead) kept[corners++] = here;
    if (here_ahead != (next.z() >= kNearPlane)) kept[corners++] = nearCrossing(here, next);
  }
  return corners;
}

/// The smallest whole number that is not below `value`, at least -1 and at most `limit`. Faster
/// than std::ceil, which is a call where the processor's instruction for it must not be used.
int ceilIndex(double value, int limit) {
  const double clamped = std::clamp(value, -1.0, static_cast<double>(limit));
  const int index = static_cast<int>(clamped);
  return index + static_cast<int>(clamped > index);
}

/// The largest whole number that is not above `value`, likewise.
int floorIndex(double value, int limit) {
  const double clamped = std::clamp(value, -1.0, static_cast<double>(limit));
  const int index = static_cast<int>(clamped);
  return index - static_cast<int>(clamped < index);
}

}  // namespace

View::View(const RigCamera& camera, double far_distance, const traffic::Vehicle& vehicle)
    : heading_(geometry::direction(vehicle.state.heading + camera.yaw * core::kDegree)),
      pitch_cosine_(std::cos(camera.pitch * core::kDegree)),
      pitch_sine_(std::sin(camera.pitch * core::kDegree)),
      far_distance_(far_distance),
      side_tangent_(std::tan(0.5 * camera.field_of_view * core::kDegree)),
      side_secant_(std::sqrt(1.0 + side_tangent_ * side_tangent_)) {
  const Eigen::Vector2d forward = geometry::direction(vehicle.state.heading);
  const Eigen::Vector2d mount =
      vehicle.state.position + camera.x * forward + camera.y * geometry::leftNormal(forward);
  eye_ = {mount.x(), mount.y(), vehicle.state.elevation + camera.z};
}

bool View::maySee(const Eigen::Vector3d& center, double radius) const {
  const Eigen::Vector3d at = toCamera(center);
  if (at.z() < kNearPlane - radius) return false;
  const Eigen::Vector3d offset = center - eye_;
  const double reach = far_distance_ + radius;
  if (offset.x() * offset.x() + offset.y() * offset.y() > reach * reach) return false;
  return std::abs(at.x()) <= at.z() * side_tangent_ + radius * side_secant_;
}

Canvas::Canvas(const RigCamera& camera, std::int64_t samples, Samples& target)
    : width_(static_cast<int>(camera.width)),
      height_(static_cast<int>(camera.height)),
      samples_(static_cast<int>(samples)),
      columns_(width_ * samples_),
      rows_(height_ * samples_),
      focal_length_(intrinsicsOf(camera).focal_length * samples_),
      middle_column_(0.5 * columns_ - 0.5),
      middle_row_(0.5 * rows_ - 0.5),
      target_(&target) {
  makeBackground(camera.pitch * core::kDegree);
}

void Canvas::makeBackground(double pitch) {
  for (int row = 0; row < rows_; ++row) {
    // Angle above the horizon of the ray through the row's middle.
    const double angle = std::atan((middle_row_ - row) / focal_length_) - pitch;
    const double height = std::min(1.0, std::abs(angle) / (30.0 * core::kDegree));
    background_.push_back(angle > 0.0 ? mix(kSkyHorizon, kSkyTop, height)
                                      : mix(kGrassHorizon, kGrassNear, std::sqrt(height)));
    background_classes_.push_back(angle > 0.0 ? SceneClass::kSky : SceneClass::kTerrain);
  }
}

bool Canvas::depthPlane(const Eigen::Vector3d& normal, const Eigen::Vector3d& point,
                        DepthPlane& plane) const {
  const double distance = normal.dot(point);
  if (std::abs(distance) <= kEdgeOn * normal.norm()) return false;
  plane.across = normal.x() / (distance * focal_length_);
  plane.down = normal.y() / (distance * focal_length_);
  plane.middle = normal.z() / distance;
  return true;
}

void Canvas::fill(const Eigen::Vector3d* points, int count, const Paint& paint) {
  Eigen::Vector3d kept[kMostCorners];
  const int corners = clipNear(points, std::min(count, kMostCorners / 2), kept);
  if (corners < 3) return;
  DepthPlane plane;
  if (!depthPlane(normalOf(points, count), points[0], plane)) return;
  Eigen::Vector2d projected[kMostCorners];
  for (int i = 0; i < corners; ++i) projected[i] = project(kept[i]);
  scan(projected, corners, plane, paint);
}

Canvas::LineEnd Canvas::lineEnd(const Eigen::Vector3d& point, const Eigen::Vector3d& side,
                                const Eigen::Vector2d& across) const {
  const Eigen::Vector2d axis = project(point);
  // How far `side` moves the point in the picture: the derivative of the projection along it.
  const Eigen::Vector2d moved = (focal_length_ * side.head<2>() - axis * side.z()) / point.z();
  const double half_width = std::abs(moved.dot(across));
  LineEnd line_end;
  Eigen::Vector2d offset = moved;
  if (half_width < kThinnest) {
    offset = kThinnest * across;
    line_end.opacity = half_width / kThinnest;
  }
  const double sign = offset.dot(across) < 0.0 ? -1.0 : 1.0;
  line_end.first = axis + sign * offset;
  line_end.second = axis - sign * offset;
  return line_end;
}

void Canvas::line(const Eigen::Vector3d& begin, const Eigen::Vector3d& end,
                  const Eigen::Vector3d& side, const Paint& paint) {
  if (begin.z() < kNearPlane && end.z() < kNearPlane) return;
  DepthPlane plane;
  if (!depthPlane((end - begin).cross(side), begin, plane)) return;
  const Eigen::Vector3d from = begin.z() < kNearPlane ? nearCrossing(begin, end) : begin;
  const Eigen::Vector3d to = end.z() < kNearPlane ? nearCrossing(begin, end) : end;
  const Eigen::Vector2d along = project(to) - project(from);
  const double length = along.norm();
  if (length < kShortest) return;
  const Eigen::Vector2d across = Eigen::Vector2d(-along.y(), along.x()) / length;
  const LineEnd first = lineEnd(from, side, across);
  const LineEnd last = lineEnd(to, side, across);
  const Eigen::Vector2d corners[4] = {first.first, first.second, last.second, last.first};
  Paint thinned = paint;
  thinned.opacity *= 0.5 * (first.opacity + last.opacity);
  if (thinned.opacity >= kFaintest) scan(corners, 4, plane, thinned);
}

void Canvas::scan(const Eigen::Vector2d* corners, int count, const DepthPlane& plane,
                  const Paint& paint) {
  const RowRange range = spanRows(corners, count);
  if (range.last < range.first) return;
  DepthPlane ranked = plane;
  ranked.across *= paint.rank;
  ranked.down *= paint.rank;
  ranked.middle *= paint.rank;
  for (int row = range.first; row <= range.last; ++row) {
    const Span span = spanOf(row, ranked);
    if (span.first > span.last) continue;
    startRow(row);
    if (!target_->labels.empty()) labelSpan(span, paint);
    paintSpan(span, paint);
  }
}

Canvas::RowRange Canvas::spanRows(const Eigen::Vector2d* corners, int count) {
  double top = kInfinity;
  double bottom = -kInfinity;
  double left = kInfinity;
  double right = -kInfinity;
  for (int i = 0; i < count; ++i) {
    top = std::min(top, corners[i].y());
    bottom = std::max(bottom, corners[i].y());
    left = std::min(left, corners[i].x());
    right = std::max(right, corners[i].x());
  }
  if (left > middle_column_ || right < -middle_column_) return {};
  RowRange range;
  range.first = std::max(0, ceilIndex(top + middle_row_, rows_));
  range.last = std::min(rows_ - 1, floorIndex(bottom + middle_row_, rows_));
  for (int row = range.first; row <= range.last; ++row) {
    target_->span_begin[static_cast<std::size_t>(row)] = kInfinity;
    target_->span_end[static_cast<std::size_t>(row)] = -kInfinity;
  }
  if (range.last < range.first) return range;
  for (int i = 0; i < count; ++i) spanEdge(corners[i], corners[i + 1 == count ? 0 : i + 1]);
  return range;
}

void Canvas::spanEdge(const Eigen::Vector2d& first, const Eigen::Vector2d& second) {
  const bool downwards = first.y() < second.y();
  const Eigen::Vector2d& upper = downwards ? first : second;
  const Eigen::Vector2d& lower = downwards ? second : first;
  const int begin = std::max(0, ceilIndex(upper.y() + middle_row_, rows_));
  const int end = std::min(rows_ - 1, floorIndex(lower.y() + middle_row_, rows_));
  const double height = lower.y() - upper.y();
  const double slope = height > 0.0 ? (lower.x() - upper.x()) / height : 0.0;
  for (int row = begin; row <= end; ++row) {
    const double at = upper.x() + (row - middle_row_ - upper.y()) * slope;
    double& span_begin = target_->span_begin[static_cast<std::size_t>(row)];
    double& span_end = target_->span_end[static_cast<std::size_t>(row)];
    span_begin = std::min(span_begin, height > 0.0 ? at : std::min(upper.x(), lower.x()));
    span_end = std::max(span_end, height > 0.0 ? at : std::max(upper.x(), lower.x()));
  }
}

Canvas::Span Canvas::spanOf(int row, const DepthPlane& plane) const {
  const double begin = target_->span_begin[static_cast<std::size_t>(row)];
  const double end = target_->span_end[static_cast<std::size_t>(row)];
  Span span;
  span.first = std::max(0, ceilIndex(begin + middle_column_, columns_));
  span.last = std::min(columns_ - 1, floorIndex(end + middle_column_, columns_));
  span.offset = static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_);
  span.constant = static_cast<float>(plane.middle + plane.down * (row - middle_row_));
  span.across = static_cast<float>(plane.across);
  span.middle = static_cast<float>(middle_column_);
  return span;
}

void Canvas::paintSpan(const Span& span, const Paint& paint) {
  Color* colors = target_->colors.data() + span.offset;
  float* depths = target_->depths.data() + span.offset;
  const Color color = paint.color;
  if (paint.opacity >= 1.0) {
    for (int i = span.first; i <= span.last; ++i) {
      const float depth = span.depthAt(i);
      const bool nearer = depth > depths[i];
      depths[i] = nearer ? depth : depths[i];
      colors[i] = nearer ? color : colors[i];
    }
    return;
  }
  for (int i = span.first; i <= span.last; ++i) {
    const float depth = span.depthAt(i);
    if (depth <= depths[i]) continue;
    depths[i] = depth;
    colors[i] = mix(colors[i], color, paint.opacity);
  }
}

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

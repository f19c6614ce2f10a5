// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "e2e_cdiff/rendering/camera_rig.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "e2e_cdiff/traffic/vehicle.h"
#include "rendering/rendered_view.h"

namespace cdiff::rendering {

// A software rasterizer: a view, what can be painted, and the canvas that is painted on.

/// Nothing nearer than this is drawn [m].
constexpr double kNearPlane = 0.25;

/// Pose of a camera on a vehicle: transforms the map frame into the optical frame (x right, y down,
/// z forward [m]). RigRenderer makes one for each image.
class View {
 public:
  /// `far_distance`: farthest ground and vehicles that are drawn [m].
  View(const RigCamera& camera, double far_distance, const traffic::Vehicle& vehicle);

  /// A direction of the map frame in the optical frame.
  Eigen::Vector3d directionToCamera(const Eigen::Vector3d& direction) const {
    // Sums of products only: a scene mirrored in y gives the negated x and the same y and z, bit by
    // bit.
    const double forward = heading_.x() * direction.x() + heading_.y() * direction.y();
    const double left = heading_.x() * direction.y() - heading_.y() * direction.x();
    return {-left, -(forward * pitch_sine_) - direction.z() * pitch_cosine_,
            forward * pitch_cosine_ - direction.z() * pitch_sine_};
  }
  /// A point of the map frame in the optical frame [m].
  Eigen::Vector3d toCamera(const Eigen::Vector3d& point) const {
    return directionToCamera(point - eye_);
  }
  /// Whether a sphere (map frame [m]) may be visible: not behind the camera, beside its view, or
  /// beyond the far distance.
  bool maySee(const Eigen::Vector3d& center, double radius) const;
  const Eigen::Vector3d& eye() const { return eye_; }  ///< map frame [m]
  double farDistance() const { return far_distance_; }

 private:
  Eigen::Vector3d eye_;
  Eigen::Vector2d heading_;
  double pitch_cosine_;
  double pitch_sine_;
  double far_distance_;
  double side_tangent_;  ///< tangent of half the field of view
  double side_secant_;   ///< sqrt(1 + side_tangent_^2)
};

// Colors of the picture, packed as 0x00bbggrr.

using Color = std::uint32_t;

constexpr Color rgb(unsigned red, unsigned green, unsigned blue) {
  return red | (green << 8) | (blue << 16);
}

/// `first` where share is 0, `second` where it is 1, rounded per channel.
inline Color mix(Color first, Color second, double share) {
  Color mixed = 0;
  for (int shift = 0; shift < 24; shift += 8) {
    const double from = (first >> shift) & 0xffu;
    const double to = (second >> shift) & 0xffu;
    mixed |= static_cast<Color>(std::floor(from + (to - from) * share + 0.5)) << shift;
  }
  return mixed;
}

/// Every channel multiplied by a factor, at most 255.
inline Color shade(Color color, double factor) {
  Color shaded = 0;
  for (int shift = 0; shift < 24; shift += 8) {
    const double value = ((color >> shift) & 0xffu) * factor + 0.5;
    shaded |= static_cast<Color>(std::min(255.0, std::floor(value))) << shift;
  }
  return shaded;
}

constexpr Color kSkyTop = rgb(92, 142, 204);
constexpr Color kSkyHorizon = rgb(205, 221, 235);
constexpr Color kGrassHorizon = rgb(142, 162, 120);
constexpr Color kGrassNear = rgb(84, 120, 58);
constexpr Color kGrassSlope = rgb(104, 136, 78);
constexpr Color kAsphalt = rgb(84, 86, 90);
constexpr Color kPavement = rgb(150, 146, 138);
constexpr Color kUnderside = rgb(58, 60, 64);
constexpr Color kWhitePaint = rgb(232, 232, 228);
constexpr Color kYellowPaint = rgb(228, 184, 44);
constexpr Color kConcrete = rgb(166, 166, 160);

/// Ranks of surfaces that lie on each other, such as a marking on the road: the inverse depth is
/// multiplied by the rank, so that the larger rank wins.
namespace rank {
constexpr double kPavement = 0.97;
constexpr double kRoad = 1.0;
constexpr double kMarking = 1.06;
constexpr double kStopLine = 1.07;
constexpr double kShadow = 1.08;
constexpr double kBody = 1.10;
constexpr double kBodyDetail = 1.101;
constexpr double kBodyLight = 1.102;
}  // namespace rank

/// What a sample shows: a class, and of a vehicle its number from 1 on.
struct Label {
  SceneClass kind = SceneClass::kSky;
  std::uint16_t instance = 0;
};

/// As Samples::labels holds it.
inline std::uint32_t packedLabel(const Label& label) {
  return static_cast<std::uint32_t>(label.kind) << 16 | label.instance;
}

/// How a shape is painted: color, rank among overlapping shapes, opacity in [0, 1], and what it is.
struct Paint {
  Color color = 0;
  double rank = rank::kRoad;
  double opacity = 1.0;
  Label label = {SceneClass::kRoad, 0};
};

/// The samples of a picture being drawn, row by row. Cameras of a rig draw into the same one after
/// another, so that they stay in the processor's cache.
struct Samples {
  /// Per row: whether it holds samples of this picture; the others are background alone.
  std::vector<std::uint8_t> drawn;
  std::vector<Color> colors;
  std::vector<float> depths;          ///< inverse depth [1/m] x rank
  std::vector<std::uint32_t> labels;  ///< class << 16 | instance; empty: not asked for
  /// Per row: both ends of the polygon being drawn, from the middle.
  std::vector<double> span_begin;
  std::vector<double> span_end;
};

/// Rasterizer of a camera: convex polygons and lines in the optical frame [m] into a
/// supersampled image (samples x samples per pixel) with a buffer of inverse depths [1/m]. A
/// polygon covers the samples whose centers lie in its closed area; of several the larger inverse
/// depth x rank stays. Image coordinates count from the middle of the picture (u right, v down
/// [samples]), so that a mirrored scene gives the mirrored picture bit by bit. Called by the parts
/// of the scene (road, signals, vehicles) through RigRenderer.
class Canvas {
 public:
  /// `samples`: per pixel and axis. What is drawn goes to `target`, which must outlive the canvas
  /// and holds one picture at a time.
  Canvas(const RigCamera& camera, std::int64_t samples, Samples& target);

  /// Starts a picture: sky and grass, and nothing in front of them. `labels`: also note what each
  /// sample shows.
  void clear(bool labels = false);
  /// Draws a convex polygon (optical frame [m]), clipped at the near plane.
  void fill(const Eigen::Vector3d* points, int count, const Paint& paint);
  /// Draws a flat line from `begin` to `end` (optical frame [m]) that reaches `side`, half its
  /// width as a vector, to both sides. Thinner than a sample it is drawn one sample wide and more
  /// transparent.
  void line(const Eigen::Vector3d& begin, const Eigen::Vector3d& end, const Eigen::Vector3d& side,
            const Paint& paint);
  /// The picture: each pixel is the mean of its samples.
  traffic::CameraImage image() const;
  /// What each pixel shows: the label of most of its samples; of labels that as many samples have
  /// the later class, then the later vehicle. After clear(true).
  void readLabels(RenderedView& view) const;

 private:
  static constexpr int kMostCorners = 16;
  /// Inverse depth [1/m] = across u + down v + middle.
  struct DepthPlane {
    double across = 0.0;
    double down = 0.0;
    double middle = 0.0;
  };
  /// One end of a line in the picture: its corners on both sides.
  struct LineEnd {
    Eigen::Vector2d first = Eigen::Vector2d::Zero();
    Eigen::Vector2d second = Eigen::Vector2d::Zero();
    double opacity = 1.0;
  };
  /// Rows of samples, both included; empty when last < first.
  struct RowRange {
    int first = 0;
    int last = -1;
  };
  /// The samples of a row that a polygon covers, with its inverse depth x rank there.
  struct Span {
    int first = 0;
    int last = -1;
    std::size_t offset = 0;  ///< of the row's first sample
    float constant = 0.0f;
    float across = 0.0f;
    float middle = 0.0f;
    float depthAt(int column) const {
      return constant + across * (static_cast<float>(column) - middle);
    }
  };
  bool depthPlane(const Eigen::Vector3d& normal, const Eigen::Vector3d& point,
                  DepthPlane& plane) const;
  Eigen::Vector2d project(const Eigen::Vector3d& point) const {
    return {focal_length_ * point.x() / point.z(), focal_length_ * point.y() / point.z()};
  }
  /// `across`: unit, perpendicular to the line in the picture.
  LineEnd lineEnd(const Eigen::Vector3d& point, const Eigen::Vector3d& side,
                  const Eigen::Vector2d& across) const;
  void scan(const Eigen::Vector2d* corners, int count, const DepthPlane& plane, const Paint& paint);
  RowRange spanRows(const Eigen::Vector2d* corners, int count);
  void spanEdge(const Eigen::Vector2d& first, const Eigen::Vector2d& second);
  Span spanOf(int row, const DepthPlane& plane) const;
  void paintSpan(const Span& span, const Paint& paint);
  void labelSpan(const Span& span, const Paint& paint);
  /// Fills a row of samples with the background, once a picture.
  void startRow(int row) const {
    if (target_->drawn[static_cast<std::size_t>(row)] == 0) fillRow(row);
  }
  void fillRow(int row) const;
  void writeBackground(int y, std::uint8_t* target) const;
  void makeBackground(double pitch);

  int width_;            ///< [px] of the image
  int height_;           ///< [px] of the image
  int samples_;          ///< per pixel and axis
  int columns_;          ///< of samples
  int rows_;             ///< of samples
  double focal_length_;  ///< [samples]
  double middle_column_;
  double middle_row_;
  Samples* target_;
  std::vector<Color> background_;               ///< per row
  std::vector<SceneClass> background_classes_;  ///< per row
};

}  // namespace cdiff::rendering

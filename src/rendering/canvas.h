// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The picture in the making: supersampled colours with a depth buffer. A sample belongs to a
/// convex polygon whose closed area holds its centre; the sample of the larger inverse depth stays.
/// Coordinates are counted from the middle of the picture, so that a mirrored scene gives the
/// mirrored picture.
#pragma once

#include <vector>

#include "e2e_cdiff/rendering/camera_options.h"
#include "e2e_cdiff/traffic/camera_image.h"
#include "rendering/color.h"

namespace cdiff::rendering {

/// What lies flat on something else has a larger rank: its inverse depth is multiplied by it.
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

struct Paint {
  Color color = 0;
  double rank = rank::kRoad;
  double opacity = 1.0;
};

class Canvas {
 public:
  explicit Canvas(const CameraOptions& options);

  /// Sky and grass, nothing in front of them.
  void clear();
  /// A convex polygon in the optical frame [m], clipped at the near plane.
  void fill(const Eigen::Vector3d* points, int count, const Paint& paint);
  /// A flat line from `begin` to `end`, `side` (half its width) wide to both sides; where it would
  /// be thinner than a sample it is as wide as one and more transparent.
  void line(const Eigen::Vector3d& begin, const Eigen::Vector3d& end, const Eigen::Vector3d& side,
            const Paint& paint);
  /// Averages the samples.
  traffic::CameraImage image() const;

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
  struct RowRange {
    int first = 0;
    int last = -1;
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
  void paintSpan(int row, const DepthPlane& plane, const Paint& paint);
  void makeBackground(const CameraOptions& options);

  int width_;            ///< [px] of the image
  int height_;           ///< [px] of the image
  int samples_;          ///< per pixel and axis
  int columns_;          ///< of samples
  int rows_;             ///< of samples
  double focal_length_;  ///< [samples]
  double middle_column_;
  double middle_row_;
  std::vector<Color> background_;  ///< per row
  std::vector<Color> colors_;
  std::vector<float> depths_;  ///< inverse [1/m], times rank
  std::vector<double> span_begin_;
  std::vector<double> span_end_;
};

}  // namespace cdiff::rendering

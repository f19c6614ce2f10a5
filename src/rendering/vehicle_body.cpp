// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "rendering/vehicle_body.h"

#include <algorithm>
#include <array>

#include "traffic/vehicle_class.h"

namespace cdiff::rendering {
namespace {

constexpr double kClearance = 0.2;  // [m] of the body above the road
constexpr Color kGlass = rgb(36, 44, 54);
constexpr Color kTire = rgb(22, 22, 24);
constexpr Color kShadow = rgb(44, 46, 50);
constexpr Color kTailLight = rgb(128, 14, 16);
constexpr Color kBrakeLight = rgb(255, 36, 24);
constexpr Color kHeadlight = rgb(255, 250, 214);
constexpr Color kTrousers = rgb(40, 46, 66);
constexpr Color kSkin = rgb(214, 168, 140);
constexpr Color kPalette[] = {rgb(206, 208, 212), rgb(60, 104, 170), rgb(150, 154, 160),
                              rgb(172, 140, 90),  rgb(52, 128, 110), rgb(226, 226, 222),
                              rgb(108, 84, 130),  rgb(70, 78, 92)};
constexpr Color kEgoRed = rgb(198, 40, 40);
constexpr Color kCbvPurple = rgb(123, 31, 162);
constexpr Color kBackgroundBlue = rgb(31, 111, 196);
/// Light from above and a little from +x of the map; its part along y is 0, so that a scene
/// mirrored in y looks the same.
constexpr double kLightX = 0.35;
constexpr double kLightZ = 0.75;

Color colorOf(traffic::VehicleRole role) {
  if (role == traffic::VehicleRole::kEgo) return kEgoRed;
  return role == traffic::VehicleRole::kCbv ? kCbvPurple : kBackgroundBlue;
}

/// A block whose upper rectangle may be smaller; x forward, y left of the vehicle's center, z above
/// the road [m].
struct Block {
  double rear_low, rear_high;    ///< x of the rear edges
  double front_low, front_high;  ///< x of the front edges
  double half_low, half_high;    ///< half width
  double low, high;              ///< z
};

/// Collects the faces of a vehicle.
class Painter {
 public:
  Painter(const traffic::Vehicle& vehicle, std::uint16_t instance)
      : instance_(instance),
        forward_(geometry::direction(vehicle.state.heading)),
        origin_(vehicle.state.position.x(), vehicle.state.position.y(), vehicle.state.elevation) {
    body_.reserve(32);
  }

  /// A face given counter-clockwise seen from outside (vehicle frame).
  template <std::size_t kCorners>
  void face(const std::array<Eigen::Vector3d, kCorners>& corners, Color color, double rank) {
    BodyFace& face = body_.emplace_back();
    for (std::size_t i = 0; i < kCorners; ++i) face.corners[i] = toMap(corners[i]);
    face.count = static_cast<int>(kCorners);
    const bool shadow = rank == rank::kShadow;
    face.paint = {color, rank, 1.0,
                  shadow ? Label{SceneClass::kRoad, 0} : Label{SceneClass::kVehicle, instance_}};
  }

  /// Brightness of a face with this outward normal (vehicle frame, unit).
  double brightness(const Eigen::Vector3d& normal) const {
    const double map_x = forward_.x() * normal.x() - forward_.y() * normal.y();
    const double light = kLightX * map_x + kLightZ * normal.z();
    // A rear is darker than sides and front, whatever the light.
    return 0.62 + 0.45 * light - 0.1 * std::max(0.0, -normal.x());
  }

  VehicleBody body() { return std::move(body_); }

 private:
  Eigen::Vector3d toMap(const Eigen::Vector3d& point) const {
    return {origin_.x() + (forward_.x() * point.x() - forward_.y() * point.y()),
            origin_.y() + (forward_.y() * point.x() + forward_.x() * point.y()),
            origin_.z() + point.z()};
  }
  std::uint16_t instance_;
  Eigen::Vector2d forward_;
  Eigen::Vector3d origin_;
  VehicleBody body_;
};

using Corners = std::array<Eigen::Vector3d, 4>;

Corners rearOf(const Block& b) {
  return {{{b.rear_low, b.half_low, b.low},
           {b.rear_low, -b.half_low, b.low},
           {b.rear_high, -b.half_high, b.high},
           {b.rear_high, b.half_high, b.high}}};
}

Corners frontOf(const Block& b) {
  return {{{b.front_low, -b.half_low, b.low},
           {b.front_low, b.half_low, b.low},
           {b.front_high, b.half_high, b.high},
           {b.front_high, -b.half_high, b.high}}};
}

Corners leftOf(const Block& b) {
  return {{{b.front_low, b.half_low, b.low},
           {b.rear_low, b.half_low, b.low},
           {b.rear_high, b.half_high, b.high},
           {b.front_high, b.half_high, b.high}}};
}

Corners rightOf(const Block& b) {
  return {{{b.rear_low, -b.half_low, b.low},
           {b.front_low, -b.half_low, b.low},
           {b.front_high, -b.half_high, b.high},
           {b.rear_high, -b.half_high, b.high}}};
}

Corners topOf(const Block& b) {
  return {{{b.rear_high, -b.half_high, b.high},
           {b.front_high, -b.half_high, b.high},
           {b.front_high, b.half_high, b.high},
           {b.rear_high, b.half_high, b.high}}};
}

/// Walls in one color, the top in another, each shaded by its direction.
void paintBlock(const Block& block, Color walls, Color top, double rank, Painter& painter) {
  const auto shaded = [&](const Eigen::Vector3d& normal) {
    return shade(walls, painter.brightness(normal));
  };
  painter.face(rearOf(block), shaded({-1, 0, 0}), rank);
  painter.face(frontOf(block), shaded({1, 0, 0}), rank);
  painter.face(leftOf(block), shaded({0, 1, 0}), rank);
  painter.face(rightOf(block), shaded({0, -1, 0}), rank);
  painter.face(topOf(block), shade(top, painter.brightness({0, 0, 1})), rank);
}

/// A pair of lights on the rear (`x` negative) or front face [m].
struct Lights {
  double x;
  double inner;  ///< distance from the middle
  double outer;  ///< likewise
  double low;    ///< above the road
  double high;   ///< above the road
};

void paintLights(const Lights& lights, Color color, Painter& painter) {
  const auto& [x, inner, outer, low, high] = lights;
  const Block right = {x, x, x, x, 0.0, 0.0, low, high};
  for (const double side : {1.0, -1.0}) {
    Corners corners = x < 0.0 ? rearOf(right) : frontOf(right);
    for (std::size_t i = 0; i < 4; ++i) {
      // First and last corner lie left of the rear face and right of the front face.
      const bool left = (i == 0 || i == 3) == (x < 0.0);
      corners[i].y() = (side > 0.0) == left ? side * outer : side * inner;
    }
    painter.face(corners, color, rank::kBodyLight);
  }
}

/// An octagon on the left (`y` positive) or right side.
std::array<Eigen::Vector3d, 8> wheelOf(double x, double y, double radius) {
  static constexpr double kCut = 0.41421356237309503;  // tan(22.5 deg)
  // Clockwise seen from the right side, so counter-clockwise seen from the left one.
  static constexpr double kOctagon[8][2] = {{1, kCut},   {1, -kCut}, {kCut, -1}, {-kCut, -1},
                                            {-1, -kCut}, {-1, kCut}, {-kCut, 1}, {kCut, 1}};
  std::array<Eigen::Vector3d, 8> corners;
  for (std::size_t i = 0; i < 8; ++i) {
    const double* at = kOctagon[y > 0.0 ? i : 7 - i];
    corners[i] = {x + radius * at[0], y, radius + radius * at[1]};
  }
  return corners;
}

void paintWheels(const traffic::VehicleDimensions& size, Painter& painter) {
  const double half = 0.5 * size.width;
  const double radius = std::clamp(0.21 * size.height, 0.28, 0.5);
  for (const double x : {-0.31 * size.length, 0.31 * size.length}) {
    painter.face(wheelOf(x, half, radius), kTire, rank::kBodyDetail);
    painter.face(wheelOf(x, -half, radius), kTire, rank::kBodyDetail);
    const Block tread = {x - radius, x - radius, x + radius, x + radius,
                         half,       half,       0.0,        kClearance};
    painter.face(rearOf(tread), kTire, rank::kBody);
    painter.face(frontOf(tread), kTire, rank::kBody);
  }
}

void paintShadow(const traffic::VehicleDimensions& size, Painter& painter) {
  const double half_length = 0.5 * size.length + 0.1;
  const double half_width = 0.5 * size.width + 0.1;
  const Block block = {-half_length, -half_length, half_length, half_length,
                       half_width,   half_width,   0.0,         0.0};
  painter.face(topOf(block), kShadow, rank::kShadow);
}

/// Body and cabin of a car.
void paintCar(const traffic::VehicleDimensions& size, Color color, Painter& painter) {
  const double rear = -0.5 * size.length;
  const double half = 0.5 * size.width;
  const double belt = 0.6 * size.height;
  paintBlock({rear, rear, -rear, -rear, half, half, kClearance, belt}, color, color, rank::kBody,
             painter);
  const double length = size.length;
  const Block cabin = {-0.46 * length, -0.36 * length, 0.24 * length, 0.06 * length,
                       0.95 * half,    0.76 * half,    belt,          size.height};
  paintBlock(cabin, kGlass, color, rank::kBody, painter);
}

/// One block with a windscreen and side windows in front.
void paintTall(const traffic::VehicleDimensions& size, Color color, Painter& painter) {
  const double front = 0.5 * size.length;
  const double half = 0.5 * size.width;
  paintBlock({-front, -front, front, front, half, half, kClearance, size.height}, color, color,
             rank::kBody, painter);
  const double low = 0.5 * size.height;
  const double high = 0.85 * size.height;
  const Block glass = {
      front - 0.2 * size.length, front - 0.2 * size.length, front, front, half, half, low, high};
  painter.face(leftOf(glass), kGlass, rank::kBodyDetail);
  painter.face(rightOf(glass), kGlass, rank::kBodyDetail);
  const Block screen = {0, 0, front, front, 0.88 * half, 0.88 * half, low, high};
  painter.face(frontOf(screen), kGlass, rank::kBodyDetail);
}

/// A person, or a plain block where the box is low.
void paintUpright(const traffic::VehicleDimensions& size, Color color, Painter& painter) {
  constexpr double kLeast = 1.0;  // height of a person [m]
  const double front = 0.5 * size.length;
  const double half = 0.5 * size.width;
  const auto block = [&](double share, double low, double high) {
    return Block{-share * front, -share * front, share * front, share * front,
                 share * half,   share * half,   low,           high};
  };
  if (size.height < kLeast)
    return paintBlock(block(1.0, 0.0, size.height), color, color, rank::kBody, painter);
  const double belt = 0.5 * size.height;
  const double neck = 0.85 * size.height;
  paintBlock(block(0.8, 0.0, belt), kTrousers, kTrousers, rank::kBody, painter);
  paintBlock(block(1.0, belt, neck), color, color, rank::kBody, painter);
  paintBlock(block(0.5, neck, size.height), kSkin, kSkin, rank::kBody, painter);
}

/// Wheels, body and lights.
void paintVehicle(const traffic::Vehicle& vehicle, Color color, Painter& painter) {
  const traffic::VehicleDimensions& size = vehicle.dimensions;
  paintWheels(size, painter);
  const bool car = traffic::classOf(size) == traffic::VehicleClass::kCar;  // with a cabin
  if (car) {
    paintCar(size, color, painter);
  } else {
    paintTall(size, color, painter);
  }
  const double half = 0.5 * size.width;
  const double low = car ? 0.34 * size.height : std::min(0.6, 0.3 * size.height);
  const double high = low + (car ? 0.2 : 0.13) * std::min(size.height, 2.5);
  const bool braking = brakeLightsOn(vehicle);
  paintLights({-0.5 * size.length, (braking ? 0.45 : 0.55) * half, 0.97 * half, low, high},
              braking ? kBrakeLight : kTailLight, painter);
  paintLights({0.5 * size.length, 0.6 * half, 0.95 * half, low, high}, kHeadlight, painter);
}

}  // namespace

bool brakeLightsOn(const traffic::Vehicle& vehicle) {
  const bool pedal = vehicle.applied_action && vehicle.applied_action->brake > 0.1;
  return pedal || vehicle.acceleration < -0.5 || vehicle.state.speed < 0.1;
}

Color bodyColor(const traffic::Vehicle& vehicle, BodyColors colors) {
  if (colors == BodyColors::kByRole) return colorOf(vehicle.role);
  std::uint32_t hash = 2166136261u;  // FNV-1a
  for (const char letter : vehicle.id)
    hash = (hash ^ static_cast<unsigned char>(letter)) * 16777619u;
  return kPalette[(hash >> 8) % (sizeof(kPalette) / sizeof(kPalette[0]))];
}

VehicleBody bodyOf(const traffic::Vehicle& vehicle, std::uint16_t instance, BodyColors colors) {
  const traffic::VehicleDimensions& size = vehicle.dimensions;
  Painter painter(vehicle, instance);
  const Color color = bodyColor(vehicle, colors);
  paintShadow(size, painter);
  if (traffic::isUpright(size)) {
    paintUpright(size, color, painter);
  } else {
    paintVehicle(vehicle, color, painter);
  }
  return painter.body();
}

void drawBody(const VehicleBody& body, const View& view, Canvas& canvas) {
  for (const BodyFace& face : body) {
    Eigen::Vector3d seen[8];
    for (int i = 0; i < face.count; ++i)
      seen[i] = view.toCamera(face.corners[static_cast<std::size_t>(i)]);
    const Eigen::Vector3d outwards = (seen[1] - seen[0]).cross(seen[2] - seen[0]);
    if (outwards.dot(seen[0]) < 0.0) canvas.fill(seen, face.count, face.paint);
  }
}

}  // namespace cdiff::rendering

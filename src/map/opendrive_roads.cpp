// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "map/opendrive_roads.h"

#include <algorithm>
#include <cmath>
#include <pugixml.hpp>
#include <vector>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::map {

using core::InputError;
using geometry::Pose2d;

// Parts of a road; not in an unnamed namespace, because the class's own type has them.
namespace opendrive {

/// a + b d + c d^2 + e d^3, where d counts from `begin` [m].
struct Cubic {
  double begin = 0.0;
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;
  double e = 0.0;

  double at(double s) const {
    const double d = s - begin;
    return a + d * (b + d * (c + d * e));
  }
};

/// A piece of a reference line.
struct Piece {
  double begin = 0.0;  ///< s at its start [m]
  double length = 0.0;
  Pose2d start;
  double first_curvature = 0.0;  ///< of a line, an arc or a spiral [1/m]
  double last_curvature = 0.0;
  bool polynomial = false;
  double scale = 1.0;  ///< of the parameter of u and v
  Cubic u;
  Cubic v;

  Pose2d at(double distance) const;
};

/// The lanes of a road from one s on.
struct Section {
  double begin = 0.0;
  std::map<int, std::vector<Cubic>> widths;  ///< by lane
};

}  // namespace opendrive

namespace {

using opendrive::Cubic;
using opendrive::Piece;
using opendrive::Section;

double number(const pugi::xml_node& node, const char* key) {
  const double value = node.attribute(key).as_double();
  if (!std::isfinite(value))
    throw InputError(std::string("<") + node.name() + ">: '" + key + "' is no finite number");
  return value;
}

Cubic cubicOf(const pugi::xml_node& node, const char* begin, double from) {
  return {from + number(node, begin), number(node, "a"), number(node, "b"), number(node, "c"),
          number(node, "d")};
}

/// The value of the last piece that begins at or before s; 0 where there is none.
double valueOf(const std::vector<Cubic>& pieces, double s) {
  double value = 0.0;
  for (const Cubic& piece : pieces)
    if (piece.begin <= s || &piece == &pieces.front()) value = piece.at(s);
  return value;
}

/// Along a line or an arc.
Pose2d alongArc(const Piece& piece, double distance) {
  const double half = 0.5 * distance * piece.first_curvature;  // of the turn
  const double chord = std::abs(half) < 1e-9 ? distance : distance * std::sin(half) / half;
  return {piece.start.position + chord * geometry::direction(piece.start.heading + half),
          piece.start.heading + 2.0 * half};
}

/// Integrates the heading of a spiral by Simpson's rule.
Pose2d alongSpiral(const Piece& piece, double distance) {
  constexpr double kStep = 0.5;  // [m]
  const double change = (piece.last_curvature - piece.first_curvature) / (2.0 * piece.length);
  const auto heading = [&](double d) {
    return piece.start.heading + d * (piece.first_curvature + d * change);
  };
  const int count = std::max(1, static_cast<int>(std::ceil(std::abs(distance) / kStep)));
  const double step = distance / count;
  Pose2d pose = piece.start;
  for (int i = 0; i < count; ++i) {
    const double d = i * step;
    pose.position +=
        step / 6.0 *
        (geometry::direction(heading(d)) + 4.0 * geometry::direction(heading(d + 0.5 * step)) +
         geometry::direction(heading(d + step)));
  }
  pose.heading = heading(distance);
  return pose;
}

}  // namespace

Pose2d opendrive::Piece::at(double distance) const {
  const bool spiral = first_curvature != last_curvature;
  if (!polynomial) return spiral ? alongSpiral(*this, distance) : alongArc(*this, distance);
  const double p = distance * scale;
  const auto slope = [&](const Cubic& cubic) {
    return cubic.b + p * (2.0 * cubic.c + p * 3.0 * cubic.e);
  };
  return {start.toMap({u.at(p), v.at(p)}), start.heading + std::atan2(slope(v), slope(u))};
}

namespace {

Piece pieceOf(const pugi::xml_node& node) {
  Piece piece;
  piece.begin = number(node, "s");
  piece.length = std::max(1e-6, number(node, "length"));
  piece.start = {{number(node, "x"), number(node, "y")}, number(node, "hdg")};
  if (const pugi::xml_node arc = node.child("arc")) {
    piece.first_curvature = piece.last_curvature = number(arc, "curvature");
  } else if (const pugi::xml_node spiral = node.child("spiral")) {
    piece.first_curvature = number(spiral, "curvStart");
    piece.last_curvature = number(spiral, "curvEnd");
  } else if (const pugi::xml_node curve = node.child("paramPoly3")) {
    piece.polynomial = true;
    const bool normalized = std::string(curve.attribute("pRange").value()) != "arcLength";
    piece.scale = normalized ? 1.0 / piece.length : 1.0;
    piece.u = {0.0, number(curve, "aU"), number(curve, "bU"), number(curve, "cU"),
               number(curve, "dU")};
    piece.v = {0.0, number(curve, "aV"), number(curve, "bV"), number(curve, "cV"),
               number(curve, "dV")};
  } else if (const pugi::xml_node poly = node.child("poly3")) {
    piece.polynomial = true;
    piece.u = {0.0, 0.0, 1.0, 0.0, 0.0};
    piece.v = {0.0, number(poly, "a"), number(poly, "b"), number(poly, "c"), number(poly, "d")};
  }
  return piece;
}

Section sectionOf(const pugi::xml_node& node, const std::string& road) {
  Section section;
  section.begin = number(node, "s");
  for (const char* side : {"left", "right"}) {
    for (const pugi::xml_node& lane : node.child(side).children("lane")) {
      std::vector<Cubic>& widths = section.widths[lane.attribute("id").as_int()];
      for (const pugi::xml_node& width : lane.children("width"))
        widths.push_back(cubicOf(width, "sOffset", section.begin));
      if (widths.empty() && lane.child("border"))
        throw InputError("road '" + road + "': lane " + lane.attribute("id").value() +
                         " has a <border>, which is not supported; expected a <width>");
    }
  }
  return section;
}

std::vector<Cubic> cubicsOf(const pugi::xml_node& parent, const char* name) {
  std::vector<Cubic> pieces;
  for (const pugi::xml_node& node : parent.children(name)) pieces.push_back(cubicOf(node, "s", 0));
  return pieces;
}

}  // namespace

/// A road with points of its reference line about 2 m apart.
struct OpenDriveRoads::Road {
  explicit Road(const pugi::xml_node& node);
  Pose2d referenceAt(double s) const;
  const Section& sectionAt(double s) const;
  /// Borders of a lane at s: t of the inner and of the outer one.
  std::optional<std::pair<double, double>> borders(int lane, double s) const;
  /// s of the nearest point of the reference line.
  double project(const Eigen::Vector2d& point) const;

  std::string id;
  double length = 0.0;
  std::vector<Piece> pieces;
  std::vector<Cubic> elevation;
  std::vector<Cubic> lane_offset;
  std::vector<Section> sections;
  std::vector<std::pair<double, Eigen::Vector2d>> samples;  ///< s and point
};

OpenDriveRoads::Road::Road(const pugi::xml_node& node)
    : id(node.attribute("id").value()),
      length(number(node, "length")),
      elevation(cubicsOf(node.child("elevationProfile"), "elevation")),
      lane_offset(cubicsOf(node.child("lanes"), "laneOffset")) {
  constexpr double kSpacing = 2.0;  // [m]
  for (const pugi::xml_node& piece : node.child("planView").children("geometry"))
    pieces.push_back(pieceOf(piece));
  for (const pugi::xml_node& section : node.child("lanes").children("laneSection"))
    sections.push_back(sectionOf(section, id));
  if (pieces.empty() || sections.empty() || length <= 0.0 || length > 1e6)
    throw InputError("road '" + id + "' has no geometry or no lanes");
  const int count = std::max(1, static_cast<int>(std::ceil(length / kSpacing)));
  for (int i = 0; i <= count; ++i) {
    const double s = length * i / count;
    samples.emplace_back(s, referenceAt(s).position);
  }
}

Pose2d OpenDriveRoads::Road::referenceAt(double s) const {
  const Piece* found = &pieces.front();
  for (const Piece& piece : pieces)
    if (piece.begin <= s) found = &piece;
  return found->at(s - found->begin);
}

const Section& OpenDriveRoads::Road::sectionAt(double s) const {
  const Section* found = &sections.front();
  for (const Section& section : sections)
    if (section.begin <= s) found = &section;
  return *found;
}

std::optional<std::pair<double, double>> OpenDriveRoads::Road::borders(int lane, double s) const {
  const Section& section = sectionAt(s);
  const int side = lane > 0 ? 1 : -1;
  double inner = valueOf(lane_offset, s);
  double outer = inner;
  for (int id_of = side; id_of != lane + side; id_of += side) {
    const auto found = section.widths.find(id_of);
    if (found == section.widths.end()) return std::nullopt;
    inner = outer;
    outer += side * std::max(0.0, valueOf(found->second, s));
  }
  return std::make_pair(inner, outer);
}

double OpenDriveRoads::Road::project(const Eigen::Vector2d& point) const {
  const auto nearest =
      std::min_element(samples.begin(), samples.end(), [&](const auto& left, const auto& right) {
        return (left.second - point).squaredNorm() < (right.second - point).squaredNorm();
      });
  double s = nearest->first;
  for (int i = 0; i < 3; ++i) s = std::clamp(s + referenceAt(s).toBody(point).x(), 0.0, length);
  return s;
}

OpenDriveRoads::OpenDriveRoads(const std::string& text, const std::string& name) : name_(name) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  const pugi::xml_node root = document.child("OpenDRIVE");
  if (!parsed || !root) throw InputError("network '" + name + "': no <OpenDRIVE> element");
  try {
    for (const pugi::xml_node& node : root.children("road")) {
      auto road = std::make_unique<const Road>(node);
      roads_[road->id] = std::move(road);
    }
  } catch (const InputError& error) {
    throw InputError("network '" + name + "': " + error.what());
  }
}

OpenDriveRoads::OpenDriveRoads(OpenDriveRoads&&) noexcept = default;
OpenDriveRoads& OpenDriveRoads::operator=(OpenDriveRoads&&) noexcept = default;
OpenDriveRoads::~OpenDriveRoads() = default;

const OpenDriveRoads::Road& OpenDriveRoads::roadOf(const std::string& id) const {
  const auto found = roads_.find(id);
  if (found != roads_.end()) return *found->second;
  std::vector<std::string> known;
  for (const auto& entry : roads_) known.push_back("'" + entry.first + "'");
  throw InputError("the network '" + name_ + "' has no road '" + id + "'; expected one of " +
                   core::shortened(core::joinText(known, ", ")));
}

const OpenDriveRoads::Road& OpenDriveRoads::roadAt(const std::string& id, double s) const {
  constexpr double kTolerance = 0.01;  // [m]
  const Road& road = roadOf(id);
  if (s >= -kTolerance && s <= road.length + kTolerance) return road;
  throw InputError("s is " + core::formatNumber(s) + " m; expected 0 to " +
                   core::formatNumber(road.length) + ", the length of road '" + id + "'");
}

geometry::Pose2d OpenDriveRoads::poseAt(const std::string& id, double s, double t) const {
  Pose2d pose = roadAt(id, s).referenceAt(s);
  pose.position = pose.toMap({0.0, t});
  return pose;
}

double OpenDriveRoads::elevationAt(const std::string& id, double s) const {
  return valueOf(roadAt(id, s).elevation, s);
}

double OpenDriveRoads::laneCenter(const std::string& id, int lane, double s) const {
  const Road& road = roadAt(id, s);
  if (lane == 0) return valueOf(road.lane_offset, s);
  const auto borders = road.borders(lane, s);
  if (borders) return 0.5 * (borders->first + borders->second);
  std::vector<std::string> known;
  for (const auto& entry : road.sectionAt(s).widths) known.push_back(std::to_string(entry.first));
  throw InputError("road '" + id + "' has no lane " + std::to_string(lane) + " at s " +
                   core::formatNumber(s) + "; expected one of " + core::joinText(known, ", "));
}

std::optional<RoadPlace> OpenDriveRoads::locate(const Eigen::Vector2d& point, double elevation,
                                                double heading) const {
  constexpr double kLevelWeight = 10.0;  // one meter of elevation counts as so many radians
  constexpr double kReach = 0.01;        // [m]
  std::optional<RoadPlace> best;
  double best_rank = 0.0;
  for (const auto& [id, road] : roads_) {
    const double s = road->project(point);
    const Pose2d reference = road->referenceAt(s);
    const Eigen::Vector2d body = reference.toBody(point);
    if (std::abs(body.x()) > 1.0) continue;
    for (const auto& entry : road->sectionAt(s).widths) {
      const auto borders = road->borders(entry.first, s);
      if (!borders) continue;  // a lane further in is missing
      const auto [low, high] = std::minmax(borders->first, borders->second);
      if (body.y() < low - kReach || body.y() > high + kReach) continue;
      const double turned = std::abs(
          core::angleDifference(heading, reference.heading + (entry.first > 0 ? core::kPi : 0.0)));
      const double rank = turned + kLevelWeight * std::abs(elevation - valueOf(road->elevation, s));
      if (best && rank >= best_rank) continue;
      best = RoadPlace{id, entry.first, s, body.y()};
      best_rank = rank;
    }
  }
  return best;
}

}  // namespace cdiff::map

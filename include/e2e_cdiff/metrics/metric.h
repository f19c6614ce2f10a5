// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <memory_resource>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "e2e_cdiff/cbv/cbv_selection.h"
#include "e2e_cdiff/map/drivable_area.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/metrics/metrics_options.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::metrics {

/// Whether a larger value is a better session.
enum class Direction { kHigherIsBetter, kLowerIsBetter, kNeither };

/// Whose driving a measure describes.
enum class Subject { kEgo, kCbvs, kEgoAndOthers };

/// What the values of several sessions are summed up to (docs/statistics.md).
enum class Pooling {
  kByUnit,     ///< unit "count": kCount; "1/km": kRate; "%": kShare; else kMean
  kMean,       ///< mean of the sessions' values
  kStatistic,  ///< the same, of a value that describes a session's samples as a whole
  kCount,      ///< events: their sum over the distance driven, per km
  kRate,       ///< events per km already: value x km is their number
  kShare,      ///< percentage of samples: the percentage of all sessions' samples together
};

/// What a session weighs in such a sum.
enum class SessionWeight {
  kByKind,         ///< counts and rates: the subject's km; shares: the subject's time; else 1
  kOne,            ///< all sessions alike
  kEgoKilometres,  ///< driven by the ego
  kCbvKilometres,  ///< driven as CBV
  kCbvDecisions,   ///< decisions with a CBV
  kCbvSelections,  ///< vehicles selected as CBV; one selected twice counts twice
  kSeconds,        ///< simulated time
  kTtcSeconds,     ///< simulated time in which the ego has a 2D time to collision
};

/// How a measure is summed up over sessions and between which values it lies, from which its
/// interval follows. The default follows from the measure's unit and subject.
struct PoolingRule {
  Pooling kind = Pooling::kByUnit;                          ///< what values are summed up to
  SessionWeight weight = SessionWeight::kByKind;            ///< what a session weighs
  double least = -std::numeric_limits<double>::infinity();  ///< no value is smaller
  double most = std::numeric_limits<double>::infinity();    ///< no value is larger
};

/// Means and statistics of values that lie between 0 and 1, between 0 and 100, anywhere.
inline constexpr PoolingRule kMeanToOne = {Pooling::kMean, SessionWeight::kOne, 0.0, 1.0};
inline constexpr PoolingRule kMeanToHundred = {Pooling::kMean, SessionWeight::kOne, 0.0, 100.0};
inline constexpr PoolingRule kStatisticToOne = {Pooling::kStatistic, SessionWeight::kOne, 0.0, 1.0};
inline constexpr PoolingRule kPlainMean = {Pooling::kMean, SessionWeight::kOne};
inline constexpr PoolingRule kPlainStatistic = {Pooling::kStatistic, SessionWeight::kOne};
/// Whole events that have another unit than "count".
inline constexpr PoolingRule kEvents = {Pooling::kCount, SessionWeight::kByKind};

/// The definition of one measure. Its texts must live as long as the program: string literals.
struct MeasureDefinition {
  const char* name;         ///< snake_case, unique; of messages and batch columns
  const char* place;        ///< JSON pointer to the number in summary.json; "": /metrics/NAME/value
  const char* label;        ///< for people
  const char* unit;         ///< "s", "%", "m/s" ..., "count" for whole numbers, "" without unit
  Direction direction;      ///< which values are better
  Subject subject;          ///< whose driving it describes
  const char* definition;   ///< sentences, source included
  const char* rift_compat;  ///< how RIFT's code differs; "" where it does not compute it otherwise
  int decimals = 3;         ///< in the report's table
  bool main = false;        ///< whether /diagnostics shows it
  PoolingRule pooling = {};  ///< how batches sum it up
};

/// What a session has for a measure.
struct Measure {
  std::optional<double> value;  ///< absent when n is too small or the measure is undefined
  std::size_t n = 0;            ///< number of samples it is based on
  std::string unit;             ///< the definition's unit, which the sink fills in
  std::string reason;  ///< why the value is absent, or how its samples were thinned out; else empty
  std::string target = {};  ///< what the samples are compared with; empty where with nothing
};

/// The ego against the vehicles on its level: minima over those where defined.
struct Interaction {
  std::optional<double> ttc_2d;            ///< vehicles within the radius [s]
  std::optional<double> ttc_2d_cbv;        ///< the same, CBVs alone [s]
  std::optional<double> ttc_lon_lat;       ///< by the paper's wording; at decision ticks [s]
  std::optional<double> rift_ttc;          ///< by RIFT's ray cast; at decision ticks [s]
  std::optional<double> rift_act;          ///< by RIFT's ACT; at decision ticks [s]
  std::optional<double> nearest_distance;  ///< between boxes, at any distance [m]
  const traffic::Vehicle* ttc_2d_partner =
      nullptr;  ///< whose time `ttc_2d` is; the first of equals
};

/// A CBV of the tick.
struct CbvSighting {
  const traffic::Vehicle* vehicle = nullptr;  ///< never null in a tick
  bool off_road = false;                      ///< whether its center is off the drivable area
  std::optional<double> wanted_speed = {};    ///< target speed capped by the lane's limit [m/s]
  std::optional<double> ego_distance = {};    ///< distance between the centers of ego and CBV [m]
  bool corner_off_road = false;               ///< whether any corner of its box is off the road
  double chord = 0.0;                         ///< driven since the last tick, where it was CBV [m]
  std::optional<double> edge_distance = {};   ///< smallest signed distance of its corners to the
                                              ///< edge of the drivable area, positive inside [m]

  /// Whether its position is finite.
  bool placed() const { return vehicle->state.position.allFinite(); }
};

/// A contact that began at the tick, with the parts that ego and CBVs have in it.
struct ContactSighting {
  std::string ego_partner;        ///< id of the other vehicle; empty in a contact without the ego
  std::vector<std::string> cbvs;  ///< ids of the CBVs in it
  std::string striker;  ///< id of the vehicle at fault; empty: not judged (docs/protocols.md)
};

/// A contact of the ego and who is at fault (docs/protocols.md).
struct EgoContact {
  std::uint64_t tick = 0;       ///< first tick with overlap
  double seconds = 0.0;         ///< its time [s]
  std::string partner;          ///< id of the other vehicle
  bool ego_at_fault = false;    ///< by the rules of docs/protocols.md
  std::string reason;           ///< why, in a short sentence
  double ego_speed = 0.0;       ///< at that tick [m/s]
  double partner_speed = 0.0;   ///< [m/s]
  std::string ego_side;         ///< "front", "rear", "left side", "right side"; empty: not known
  std::string partner_side;     ///< likewise
  double x = 0.0;               ///< place of the contact, map frame [m]
  double y = 0.0;               ///< [m]
  bool braking_avoids = false;  ///< whether braking alone would have avoided it (docs/metrics.md)
  bool with_cbv = false;        ///< whether the other was a CBV; else it was background traffic
};

/// One tick as metrics see it: the snapshot, the selection, and what several metrics need of them
/// (map frame, SI units). The actions are in the snapshot (`traffic::Vehicle::applied_action`).
struct MetricTick {
  const traffic::TrafficSnapshot& snapshot;      ///< of the tick
  const cbv::CbvSelection* selection = nullptr;  ///< at decision ticks, where known; else nullptr
  const traffic::Vehicle* ego = nullptr;         ///< nullptr without one
  bool ego_off_road = false;                     ///< whether its center is off the drivable area
  double ego_arc_length = 0.0;                   ///< farthest place reached along the ego route [m]
  double route_completion_percent = 0.0;  ///< the ego's route completion, by the protocol's rule
  Interaction interaction = {};           ///< the ego against the others
  std::vector<CbvSighting> cbvs = {};     ///< vehicles whose role is CBV, in the snapshot's order
  std::vector<ContactSighting> contacts = {};  ///< that began at this tick
  std::vector<EgoContact> ego_contacts = {};   ///< that began at this tick, judged
};

/// What a metric may keep for the session; all references outlive the metric.
struct MetricContext {
  const map::DrivableArea& drivable_area;  ///< of the session's network
  const map::Route& ego_route;             ///< the ego's route
  const SessionMetricsOptions& options;    ///< what metrics know about the scenario
  /// For what grows with the session: gives nothing back before the session ends.
  std::pmr::memory_resource* memory = std::pmr::get_default_resource();
};

/// Keys and values of one entry of a list in summary.json, in order.
using MetricEntry =
    std::vector<std::pair<std::string, std::variant<std::nullptr_t, bool, double, std::string>>>;

/// Takes what a metric reports.
class MetricSink {
 public:
  virtual ~MetricSink() = default;
  /// Sets one of the metric's measures, whose unit becomes that of `definition`. Throws core::Error
  /// for a definition that the metric's descriptor does not have.
  virtual void set(const MeasureDefinition& definition, Measure measure) = 0;
  /// A list beside the measures of a part of summary.json, by JSON pointer ("/cbv/NAME").
  virtual void setList(const std::string& place, std::vector<MetricEntry> entries) = 0;
};

/// The interface of everything that is measured in a session, and its registration. A metric
/// observes each tick, reports its measures, and appears in summary.json, the report, the messages,
/// the batch columns and the list of definitions by its descriptor alone.
class Metric {
 public:
  virtual ~Metric() = default;
  /// Every tick of the session, in order.
  virtual void observe(const MetricTick& tick) = 0;
  /// The measures so far; each has a value or a reason.
  virtual void report(MetricSink& sink) const = 0;
};

/// What is known about a metric before a session: name, the measures it defines, and its
/// constructor.
struct MetricDescriptor {
  std::string name;                         ///< snake_case, unique
  std::string help;                         ///< a sentence
  std::vector<MeasureDefinition> measures;  ///< in the order of the table; names and places unique
  std::function<std::unique_ptr<Metric>(const MetricContext&)> make;  ///< for one session
  std::string source = "e2e_cdiff";  ///< who registers it; a plug-in gives its file
};

/// Sessions that begin from now on measure it, too. Call at start or when a plug-in is loaded, from
/// one thread. Throws core::InputError for a descriptor without name, measures or `make`, and for a
/// metric, measure or place that is registered already, naming both sources.
void registerMetric(MetricDescriptor descriptor);

}  // namespace cdiff::metrics

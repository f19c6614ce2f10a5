// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <optional>
#include <set>

#include "collection/collection_options.h"
#include "core/file.h"
#include "diffusion/network/architecture.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "e2e_cdiff/geometry/shapes.h"
#include "node_graph/bags/dataset_from_bag.h"
#include "node_graph/recorded_bag.h"
#include "std_msgs/String.h"
#include "support/sumo_network.h"

namespace cdiff::node_graph {
namespace {

using collection::DatasetOptions;
using collection::DatasetStatistics;

/// What a session's samples are compared with.
class Witness : public session::SessionObserver {
 public:
  explicit Witness(const collection::CollectionLoop& loop) : loop_(loop) {}
  void observe(const session::TickRecord& record) override {
    if (record.actions == nullptr) return;
    for (const planning::PlannedAction& action : *record.actions) {
      if (loop_.perturbed(action.vehicle_id))
        perturbed.insert({action.vehicle_id, record.snapshot->tick});
      for (const session::SlotImage& seen : *record.images) {
        if (seen.slot == action.slot)
          images[{action.vehicle_id, record.snapshot->tick}] = seen.image.rgb;
      }
    }
  }
  std::set<std::pair<std::string, std::uint64_t>> perturbed;
  std::map<std::pair<std::string, std::uint64_t>, std::vector<std::uint8_t>> images;

 private:
  const collection::CollectionLoop& loop_;
};

DatasetOptions noneDisplaced() {
  DatasetOptions options;
  options.offset_share = 0.0;
  return options;
}

DatasetOptions allDisplaced() {
  DatasetOptions options;
  options.offset_share = 1.0;
  return options;
}

/// From where the vehicle gets to the line of its route tokens [m]; nullopt before the first token.
std::optional<double> distanceAtTheEnd(const learning::DrivingSample& sample) {
  constexpr double kTokenScale = diffusion::kRouteTokenScale;
  const auto last = sample.rollout.row(sample.rollout.rows() - 1);
  if (last(traffic::kRolloutX) < 3.5) return std::nullopt;
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i + 1 < sample.route.size(); i += 2)
    points.emplace_back(kTokenScale * sample.route[i], kTokenScale * sample.route[i + 1], 0.0);
  const geometry::Polyline line(points);
  const Eigen::Vector2d end(last(traffic::kRolloutX), last(traffic::kRolloutY));
  return (line.positionAt(line.project(end).arc_length) - end).norm();
}

/// One session of 10 s, recorded for all tests.
class DatasetFromBag : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<test::TemporaryFolder>();
    record(bag(), true);
  }
  static void TearDownTestSuite() {
    witness_.reset();
    folder_.reset();
  }
  static std::filesystem::path bag() { return folder_->path() / "session.bag"; }

  static void record(const std::filesystem::path& file, bool images) {
    std::unique_ptr<Witness> witness;
    test::recordCollection(file, images ? 10.0 : 0.5, images,
                           [&](const session::SessionSetup&, collection::CollectionLoop& loop) {
                             witness = std::make_unique<Witness>(loop);
                             loop.addObserver(*witness);
                           });
    if (images) witness_ = std::move(witness);
  }

  static std::string errorOf(const std::filesystem::path& file) {
    DatasetStatistics statistics;
    try {
      samplesFromBag(file, {}, statistics);
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "";
  }

  static inline std::unique_ptr<test::TemporaryFolder> folder_;
  static inline std::unique_ptr<Witness> witness_;
};

TEST_F(DatasetFromBag, RolloutsAreWhatTheDynamicsDoesWithTheirActions) {
  DatasetStatistics statistics;
  const auto samples = samplesFromBag(bag(), allDisplaced(), statistics);
  ASSERT_GT(samples.size(), 10u);
  ASSERT_GT(statistics.kinds["displaced"], 10u);
  const dynamics::BicycleModel model;
  for (const learning::DrivingSample& sample : samples) {
    collection::schemaOf({}).check(sample);
    traffic::VehicleState state;
    state.speed = sample.speed;
    for (Eigen::Index t = 0; t < sample.rollout.rows(); ++t) {
      const auto row = sample.rollout.row(t);
      state = model.step(state, {row(4), row(5), row(6)}, 0.1);
      EXPECT_NEAR(row(0), state.position.x(), 1e-6);
      EXPECT_NEAR(row(1), state.position.y(), 1e-6);
      EXPECT_NEAR(row(2), state.heading, 1e-6);
      EXPECT_NEAR(row(3), state.speed, 1e-6);
    }
  }
}

TEST_F(DatasetFromBag, NoSampleHoldsNoiseAndEachHasItsImage) {
  DatasetStatistics statistics;
  const auto samples = samplesFromBag(bag(), noneDisplaced(), statistics);
  EXPECT_GT(statistics.dropped["disturbed"], 0u);
  for (const learning::DrivingSample& sample : samples) {
    for (std::uint64_t t = 0; t < 32; ++t) {
      EXPECT_EQ(witness_->perturbed.count({sample.vehicle, sample.tick + 2 * t}), 0u)
          << sample.vehicle << " tick " << sample.tick;
    }
    EXPECT_EQ(sample.image.rgb, witness_->images.at({sample.vehicle, sample.tick}));
  }
}

// What the vehicle was shown 0.4 s before, where that image was recorded.
TEST_F(DatasetFromBag, TheImageBeforeHasTheBytesThatTheVehicleSawThen) {
  DatasetStatistics statistics;
  std::size_t compared = 0;
  std::size_t known = 0;
  for (const learning::DrivingSample& sample : samplesFromBag(bag(), noneDisplaced(), statistics)) {
    EXPECT_TRUE(std::isnan(sample.target_speed)) << "no bag says it";
    if (sample.previous_image.empty()) continue;
    ++known;
    EXPECT_NE(sample.previous_image.rgb, sample.image.rgb);
    const auto seen = witness_->images.find({sample.vehicle, sample.tick - 8});
    if (seen == witness_->images.end()) continue;
    ++compared;
    EXPECT_EQ(sample.previous_image.rgb, seen->second) << sample.vehicle << ' ' << sample.tick;
  }
  EXPECT_GT(known, 10U);
  EXPECT_GT(compared, 0U);
}

TEST_F(DatasetFromBag, DisplacedSamplesLookFromBesideTheRouteAndReturnToIt) {
  DatasetStatistics statistics;
  const auto samples = samplesFromBag(bag(), allDisplaced(), statistics);
  double off_route = 0.0;
  std::size_t displaced = 0;
  std::size_t arrived = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const learning::DrivingSample& own = samples[i - 1];
    const learning::DrivingSample& beside = samples[i];
    if (own.vehicle != beside.vehicle || own.tick != beside.tick) continue;
    ++displaced;
    EXPECT_TRUE(beside.recovering);
    EXPECT_NE(beside.image.rgb, own.image.rgb);
    EXPECT_NE(beside.route, own.route);
    const auto distance = distanceAtTheEnd(beside);
    if (!distance) continue;
    ++arrived;
    off_route += *distance;
  }
  EXPECT_EQ(displaced, statistics.kinds["displaced"]);
  ASSERT_GT(arrived, 10u);
  // Displaced by 0.375 m and 6 degrees on average.
  EXPECT_LT(off_route / static_cast<double>(arrived), 0.2);
}

TEST_F(DatasetFromBag, EveryImageIsCountedOnce) {
  DatasetStatistics statistics;
  const auto samples = samplesFromBag(bag(), allDisplaced(), statistics);
  std::uint64_t dropped = 0;
  for (const auto& [reason, count] : statistics.dropped) dropped += count;
  EXPECT_EQ(statistics.samples, samples.size());
  EXPECT_EQ(statistics.images + statistics.kinds["displaced"], samples.size() + dropped);
  EXPECT_EQ(statistics.images, witness_->images.size());
  std::uint64_t by_speed = 0;
  for (const std::uint64_t count : statistics.speeds) by_speed += count;
  EXPECT_EQ(by_speed, statistics.samples);
}

TEST_F(DatasetFromBag, BadBagsAreNamedErrors) {
  const auto in = [](const std::string& name) { return folder_->path() / name; };
  EXPECT_NE(errorOf(in("none.bag")).find("none.bag"), std::string::npos);
  core::writeFileAtomically(in("text.bag"), "not a bag");
  EXPECT_NE(errorOf(in("text.bag")).find("text.bag"), std::string::npos);
  {
    rosbag::Bag foreign(in("foreign.bag").string(), rosbag::bagmode::Write);
    foreign.write("/words", ros::TIME_MIN, std_msgs::String());
  }
  EXPECT_NE(errorOf(in("foreign.bag")).find("holds no session"), std::string::npos);
  record(in("blind.bag"), false);
  EXPECT_NE(errorOf(in("blind.bag")).find("no camera images"), std::string::npos);
}

}  // namespace
}  // namespace cdiff::node_graph

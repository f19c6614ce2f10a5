// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "collection/scene_recorder.h"
#include "e2e_cdiff/core/options.h"
#include "learning/samples/scene_file.h"
#include "node_graph/bags/dataset_from_bag.h"
#include "node_graph/recorded_bag.h"
#include "rendering/front_camera.h"
#include "support/temporary_folder.h"

namespace cdiff::node_graph {
namespace {

std::unique_ptr<session::SessionSetup> setupOf(const learning::Scene& scene) {
  session::ScenarioOptions options;
  core::loadOptions({"scenario of scene '" + scene.name + "'", scene.scenario_yaml}, options);
  map::ImportedNetwork import;
  import.source = scene.network_source;
  import.source_sha256 = scene.network_source_sha256;
  import.text = scene.network_text;
  return std::make_unique<session::SessionSetup>(options, std::move(import),
                                                 scene.drives.front().route_points);
}

/// The session of a scene with the setup that it was driven in, without images.
collection::DrivenSession drivenSession(const learning::Scene& scene) {
  collection::DrivenSession session;
  session.name = scene.name;
  session.setup = setupOf(scene);
  session.decisions = scene.decisions;
  session.disturbed = scene.disturbed;
  session.seconds = scene.seconds;
  for (const learning::SceneDrive& drive : scene.drives) {
    const bool ego = &drive == &scene.drives.front();
    session.routes[{drive.vehicle_id, drive.selected_tick}] =
        ego ? session.setup->egoRoute() : learning::routeOf(scene, drive, session.setup->network());
  }
  for (std::size_t i = 0; i < scene.driven.size(); ++i) {
    for (const auto& [slot, number] : scene.driven[i]) {
      const learning::SceneDrive& drive = scene.drives.at(number);
      session.drives[scene.decisions.at(i).tick][slot] = {drive.vehicle_id, drive.selected_tick};
    }
  }
  for (const auto& [tick, contact] : scene.contacts) {
    session.contacts[contact.first].push_back(tick);
    session.contacts[contact.second].push_back(tick);
  }
  return session;
}

/// One session of 6 s, recorded as a bag with images and as a scene, which is read from its bytes.
class SceneOfSession : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    const test::TemporaryFolder folder;
    const std::filesystem::path file = folder.path() / "session.bag";
    std::optional<collection::SceneRecorder> scene;
    test::recordCollection(
        file, 6.0, true, [&](const session::SessionSetup& setup, collection::CollectionLoop& loop) {
          loop.addObserver(scene.emplace(setup, collection::driverQueries(loop)));
        });
    recorded_.emplace(readSessionBag(file));
    scene_ = learning::sceneOf(learning::sceneBytes(scene->take()), "scene");
  }
  static void TearDownTestSuite() { recorded_.reset(); }

  static inline std::optional<collection::DrivenSession> recorded_;
  static inline learning::Scene scene_;
};

TEST_F(SceneOfSession, ImagesRenderedFromItAreThoseOfTheSession) {
  const collection::DrivenSession session = drivenSession(scene_);
  rendering::FrontCamera camera(session.setup->options().camera, session.setup->network());
  ASSERT_GT(recorded_->images.size(), 20U);
  std::map<std::uint64_t, const traffic::TrafficSnapshot*> by_tick;
  for (const traffic::TrafficSnapshot& snapshot : session.decisions)
    by_tick[snapshot.tick] = &snapshot;
  for (const collection::DrivenImage& seen : recorded_->images) {
    const traffic::TrafficSnapshot& snapshot = *by_tick.at(seen.image.tick);
    const traffic::Vehicle* vehicle = snapshot.cbv(seen.slot);
    if (seen.slot == traffic::kEgoSlot) vehicle = snapshot.ego();
    ASSERT_NE(vehicle, nullptr);
    EXPECT_EQ(camera.render(snapshot, *vehicle).rgb, seen.image.rgb)
        << vehicle->id << " tick " << seen.image.tick;
  }
}

TEST_F(SceneOfSession, GivesTheSamplesOfItsBag) {
  collection::DrivenSession session = drivenSession(scene_);
  session.images = recorded_->images;
  collection::DatasetStatistics from_scene, from_bag;
  const auto samples = collection::samplesOf(session, {}, from_scene);
  const auto expected = collection::samplesOf(*recorded_, {}, from_bag);
  EXPECT_EQ(collection::toJson(from_scene), collection::toJson(from_bag));
  ASSERT_EQ(samples.size(), expected.size());
  ASSERT_GT(samples.size(), 5U);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(samples[i].vehicle, expected[i].vehicle);
    EXPECT_EQ(samples[i].tick, expected[i].tick);
    EXPECT_EQ(samples[i].session, expected[i].session);
    EXPECT_EQ(samples[i].rollout, expected[i].rollout);
    EXPECT_EQ(samples[i].route, expected[i].route);
    EXPECT_EQ(samples[i].image.rgb, expected[i].image.rgb);
    EXPECT_EQ(samples[i].recovering, expected[i].recovering);
    EXPECT_EQ(samples[i].stop_reason, expected[i].stop_reason);
  }
}

TEST_F(SceneOfSession, NamesWhoDrivesHowAndWhereTo) {
  EXPECT_EQ(scene_.name, "crossing_left_turn_seed3");
  EXPECT_EQ(scene_.drives.front().vehicle_id, "ego");
  ASSERT_GT(scene_.drives.size(), 1U);
  for (const learning::SceneDrive& drive : scene_.drives) {
    EXPECT_GE(drive.driver.target_speed, 5.0);
    EXPECT_LE(drive.driver.target_speed, 12.0);
    EXPECT_GE(drive.driver.acceleration, 1.5);
    EXPECT_LE(drive.driver.acceleration, 3.5);
    EXPECT_EQ(drive.conflict_point, drive.route_points.back());
  }
}

}  // namespace
}  // namespace cdiff::node_graph

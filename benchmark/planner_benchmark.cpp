// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <memory>

#include "benchmark.h"
#include "e2e_cdiff/core/random.h"
#include "e2e_cdiff/planning/diffusion_planner.h"
#include "e2e_cdiff/scenario/session_request.h"
#include "e2e_cdiff/scenario/session_setup.h"
#ifdef E2E_CDIFF_EAGER
#include "eager_planner.h"
#endif

namespace cdiff::benchmark {
namespace {

constexpr int kDecisions = 60;
constexpr int kVehicles = 8;

/// CBVs that stand one behind the other on the ego route of a shipped scenario, each with an image
/// of its own.
class Scene {
 public:
  Scene() : setup_(scenario::resolveRequest(request())) {
    for (int i = 0; i <= kVehicles; ++i) {
      traffic::Vehicle vehicle;
      const double s = 5.0 + 8.0 * i;
      vehicle.id = i == 0 ? "ego" : "cbv" + std::to_string(i);
      vehicle.role = i == 0 ? traffic::VehicleRole::kEgo : traffic::VehicleRole::kCbv;
      vehicle.cbv_slot = i - 1;
      vehicle.state.position = setup_.egoRoute().path().pointAt(s).head<2>();
      vehicle.state.heading = setup_.egoRoute().path().headingAt(s);
      vehicle.state.speed = 5.0;
      snapshot_.vehicles.push_back(vehicle);
    }
    images_.resize(kVehicles);
    renewImages();
  }

  /// A decision later; every vehicle sees something new if asked.
  void advance(bool new_images) {
    snapshot_.tick += 2;
    if (new_images) renewImages();
    for (traffic::CameraImage& image : images_) image.tick = snapshot_.tick;
  }
  std::vector<planning::PlanningTask> tasks(int first, int count) {
    std::vector<planning::PlanningTask> tasks;
    for (int i = first; i < first + count; ++i) {
      const auto index = static_cast<std::size_t>(i);
      tasks.push_back(
          {i, &snapshot_.vehicles[index + 1], &setup_.egoRoute(), 8.0, &images_[index]});
    }
    return tasks;
  }
  const scenario::SessionSetup& setup() const { return setup_; }
  const traffic::TrafficSnapshot& snapshot() const { return snapshot_; }

 private:
  static scenario::SessionRequest request() {
    scenario::SessionRequest request;
    request.scenario = "crossing_straight";
    return request;
  }
  void renewImages() {
    const core::RandomStream random(snapshot_.tick + 1, "benchmark");
    for (std::size_t i = 0; i < images_.size(); ++i) {
      images_[i].width = 160;
      images_[i].height = 96;
      images_[i].rgb.resize(160 * 96 * 3);
      for (std::size_t j = 0; j < images_[i].rgb.size(); ++j) {
        images_[i].rgb[j] =
            static_cast<std::uint8_t>(random.index({i, 0, 0}, static_cast<std::uint32_t>(j), 256));
      }
    }
  }

  scenario::SessionSetup setup_;
  traffic::TrafficSnapshot snapshot_;
  std::vector<traffic::CameraImage> images_;
};

std::unique_ptr<planning::DiffusionPlanner> makePlanner(const Scene& scene,
                                                        const std::string& mode) {
  planning::DiffusionOptions options;
  options.sampler.mode = mode;
  return std::make_unique<planning::DiffusionPlanner>(options, scene.setup().options().guidance,
                                                      scene.setup().options().vehicle,
                                                      scene.setup().planningContext());
}

/// Milliseconds of planning `count` vehicles in one call, ascending.
std::vector<double> planTimes(Scene& scene, const std::string& mode, int count, bool new_images) {
  const auto planner = makePlanner(scene, mode);
  std::vector<double> times;
  for (int i = 0; i < kDecisions; ++i) {
    scene.advance(new_images);
    const auto tasks = scene.tasks(0, count);
    const double seconds = secondsOf([&] { planner->plan(scene.snapshot(), tasks); });
    if (i > 2) times.push_back(1e3 * seconds);
  }
  std::sort(times.begin(), times.end());
  return times;
}

/// The same vehicles one call each [ms].
double singlesTime(Scene& scene) {
  std::vector<std::unique_ptr<planning::DiffusionPlanner>> planners;
  for (int i = 0; i < kVehicles; ++i) planners.push_back(makePlanner(scene, "real_time"));
  std::vector<double> times;
  for (int round = 0; round < 20; ++round) {
    scene.advance(false);
    const double seconds = secondsOf([&] {
      for (int i = 0; i < kVehicles; ++i)
        planners[static_cast<std::size_t>(i)]->plan(scene.snapshot(), scene.tasks(i, 1));
    });
    if (round > 2) times.push_back(1e3 * seconds);
  }
  return median(times);
}

double p95(const std::vector<double>& ascending) { return ascending[ascending.size() * 95 / 100]; }

void addEager(Figures& figures) {
#ifdef E2E_CDIFF_EAGER
  const double encoder = 1e3 * eagerEncoderSeconds();
  const double step = 1e3 * eagerGuidedStepSeconds();
  figures.push_back({"libtorch_eager_encoder_p50", encoder, "ms", ""});
  figures.push_back({"libtorch_eager_guided_step_p50", step, "ms", ""});
  figures.push_back({"libtorch_eager_paper_mode", encoder + 100.0 * step, "ms", ""});
#else
  (void)figures;
#endif
}

}  // namespace

void benchmarkPlanner(Figures& figures) {
  Scene scene;
  const std::vector<double> paper = planTimes(scene, "paper", 1, true);
  const std::vector<double> real_time = planTimes(scene, "real_time", 1, true);
  const std::vector<double> cached = planTimes(scene, "real_time", 1, false);
  const std::vector<double> batch = planTimes(scene, "real_time", kVehicles, false);
  const double singles = singlesTime(scene);
  figures.push_back({"planner_paper_p50", median(paper), "ms", "<=140"});
  figures.push_back({"planner_paper_p95", p95(paper), "ms", ""});
  figures.push_back({"planner_real_time_p50", median(real_time), "ms", "<=50"});
  figures.push_back({"planner_real_time_p95", p95(real_time), "ms", "<=encoder_image_p95+8"});
  figures.push_back({"planner_real_time_cached_p50", median(cached), "ms", "<=5"});
  figures.push_back({"planner_real_time_cached_p95", p95(cached), "ms", ""});
  figures.push_back({"planner_eight_cbvs_cached_p50", median(batch), "ms", "<=25"});
  figures.push_back(
      {"planner_eight_in_batch_per_eight_singles", median(batch) / singles, "", "<=0.75"});
  addEager(figures);
}

}  // namespace cdiff::benchmark

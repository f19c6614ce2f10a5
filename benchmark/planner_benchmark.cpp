// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <map>
#include <memory>

#include "benchmark.h"
#include "core/text.h"
#include "decision_scene.h"
#include "e2e_cdiff/core/exceptions.h"
#include "fma_peak.h"
#include "network_times.h"
#include "planners/diffusion/diffusion_options.h"
#include "planners/diffusion/diffusion_planner.h"
#ifdef E2E_CDIFF_EAGER
#include "eager_planner.h"
#endif

namespace cdiff::benchmark {
namespace {

constexpr int kDecisions = 60;
constexpr int kVehicles = DecisionScene::kCbvs;
constexpr int kRounds = 12;
constexpr int kFirstDecisions = 3;  // are not timed

/// What is planned with: sampler mode, guidance profile, precision of the encoder and threads.
struct Setting {
  const char* mode;
  const char* profile;
  const char* precision = "auto";
  std::int64_t threads = 1;
};

/// The paper's three naturalistic objectives, whatever the default profile holds.
constexpr const char* kThreeObjectives = "ablation_all";
constexpr const char* kDefaultProfile = "naturalistic";
constexpr const char* kAttackProfile = "safety_critical";  // several samples a vehicle

std::unique_ptr<planners::DiffusionPlanner> makePlanner(const DecisionScene& scene,
                                                        const Setting& setting) {
  planners::DiffusionOptions options;
  options.sampler.mode = setting.mode;
  options.precision = setting.precision;
  options.threads = setting.threads;
  return std::make_unique<planners::DiffusionPlanner>(
      options, guidance::loadProfile(setting.profile), scene.setup().options().vehicle,
      scene.setup().planningContext());
}

/// Milliseconds of planning `count` vehicles in one call, ascending.
std::vector<double> planTimes(DecisionScene& scene, const Setting& setting, int count,
                              bool new_images, int decisions = kDecisions) {
  const auto planner = makePlanner(scene, setting);
  std::vector<double> times;
  for (int i = 0; i < decisions; ++i) {
    scene.advance(new_images);
    const auto tasks = scene.tasks(0, count);
    const double seconds = secondsOf([&] { planner->plan(scene.snapshot(), tasks); });
    if (i >= kFirstDecisions) times.push_back(1e3 * seconds);
  }
  std::sort(times.begin(), times.end());
  return times;
}

/// The same vehicles one call each, by one planner with one copy of the model [ms]. It forgets a
/// vehicle that it is not asked about, so each is planned once to have its features at hand, and
/// then timed.
double singlesTime(DecisionScene& scene, const Setting& setting) {
  const auto planner = makePlanner(scene, setting);
  std::vector<double> times;
  for (int round = 0; round < kRounds; ++round) {
    double seconds = 0.0;
    for (int i = 0; i < kVehicles; ++i) {
      scene.advance(false);
      planner->plan(scene.snapshot(), scene.tasks(i, 1));
      scene.advance(false);
      const auto tasks = scene.tasks(i, 1);
      seconds += secondsOf([&] { planner->plan(scene.snapshot(), tasks); });
    }
    if (round > 0) times.push_back(1e3 * seconds);
  }
  return median(times);
}

double p95(const std::vector<double>& ascending) { return ascending[ascending.size() * 95 / 100]; }

/// Precisions that this processor computes with, in the order of their names in `all`.
std::vector<std::string> precisionsHere() {
  std::vector<std::string> here;
  for (const std::string name : {"fp32", "bf16", "int8"}) {
    try {
      inference::precisionNamed(name, "auto", "precision");
      here.push_back(name);
    } catch (const core::InputError&) {
    }
  }
  return here;
}

/// The encoder alone and one decision with it, in each precision.
void addPrecisions(Figures& figures, DecisionScene& scene) {
  const diffusion::Model model = diffusion::loadModel("default");
  for (const std::string& name : precisionsHere()) {
    const auto precision = inference::precisionNamed(name, "auto", "precision");
    const double encoder = median(encoderTimes(model, precision));
    const Setting setting{"real_time", kThreeObjectives, name.c_str()};
    const double decision = median(planTimes(scene, setting, 1, true));
    figures.push_back({"planner_encoder_" + name + "_p50", 1e3 * encoder, "ms", ""});
    figures.push_back({"planner_real_time_" + name + "_p50", decision, "ms", ""});
  }
}

/// The encoder alone and both networks' share of the peak, in float32. Returns the encoder's p95 in
/// the precision that decisions take [ms].
double addNetworks(Figures& figures) {
  const diffusion::Model model = diffusion::loadModel("default");
  const std::vector<double> encoder = encoderTimes(model, inference::Precision::kFp32);
  diffusion::CpuDenoiser denoiser(model);
  const DenoiserTimes unet = denoiserTimes(denoiser, 1);
  const double peak = measureFmaPeak();
  const double encoder_rate = encoderOperations(model.architecture) / median(encoder);
  const double unet_rate = 2.0 * unetOperations(model) / unet.both;
  figures.push_back({"planner_encoder_p50", 1e3 * median(encoder), "ms", ""});
  figures.push_back({"planner_encoder_p95", 1e3 * p95(encoder), "ms", ""});
  figures.push_back({"planner_fma_peak", 1e-9 * peak, "GFLOP/s", ""});
  figures.push_back({"planner_encoder_share_of_peak", 100.0 * encoder_rate / peak, "%", ""});
  figures.push_back({"planner_unet_share_of_peak", 100.0 * unet_rate / peak, "%", ""});
  const auto automatic = inference::precisionNamed("auto", "auto", "precision");
  const double automatic_p95 = 1e3 * p95(encoderTimes(model, automatic));
  figures.push_back({"planner_encoder_auto_p95", automatic_p95, "ms", ""});
  return automatic_p95;
}

void addEager(Figures& figures, DecisionScene& scene) {
#ifdef E2E_CDIFF_EAGER
  const double ours = median(planTimes(scene, {"real_time", kThreeObjectives}, 1, true));
  const double eager = 1e3 * eagerRealTimeSeconds();
  figures.push_back({"libtorch_eager_encoder_p50", 1e3 * eagerEncoderSeconds(), "ms", ""});
  figures.push_back({"libtorch_eager_paper_p50", 1e3 * eagerPaperSeconds(), "ms", ""});
  figures.push_back({"libtorch_eager_real_time_p50", eager, "ms", ""});
  figures.push_back({"planner_real_time_speedup_over_eager", eager / ours, "times", ">=7"});
#else
  (void)scene;
  (void)figures;
#endif
}

/// Image to command, one vehicle.
void addSingles(Figures& figures, DecisionScene& scene, double encoder_p95) {
  const std::vector<double> paper = planTimes(scene, {"paper", kThreeObjectives}, 1, true);
  const std::vector<double> paper_default = planTimes(scene, {"paper", kDefaultProfile}, 1, true);
  const std::vector<double> real_time = planTimes(scene, {"real_time", kThreeObjectives}, 1, true);
  const std::vector<double> real_time_default =
      planTimes(scene, {"real_time", kDefaultProfile}, 1, true);
  const std::vector<double> attack = planTimes(scene, {"real_time", kAttackProfile}, 1, true);
  const std::vector<double> cached = planTimes(scene, {"real_time", kThreeObjectives}, 1, false);
  const std::vector<double> cached_default =
      planTimes(scene, {"real_time", kDefaultProfile}, 1, false);
  figures.push_back({"planner_paper_p50", median(paper), "ms", "<=140"});
  figures.push_back({"planner_paper_p95", p95(paper), "ms", ""});
  figures.push_back({"planner_paper_default_profile_p50", median(paper_default), "ms", ""});
  figures.push_back({"planner_real_time_p50", median(real_time), "ms", "<=50"});
  figures.push_back({"planner_real_time_p95", p95(real_time), "ms",
                     "<=" + core::formatFixed(encoder_p95 + 8.0, 3)});
  figures.push_back({"planner_real_time_default_profile_p50", median(real_time_default), "ms", ""});
  figures.push_back({"planner_real_time_attack_profile_p50", median(attack), "ms", ""});
  figures.push_back({"planner_real_time_cached_p50", median(cached), "ms", "<=5"});
  figures.push_back({"planner_real_time_cached_p95", p95(cached), "ms", ""});
  figures.push_back(
      {"planner_real_time_cached_default_profile_p50", median(cached_default), "ms", ""});
}

/// Eight vehicles, image features at hand.
void addBatch(Figures& figures, DecisionScene& scene) {
  const Setting three{"real_time", kThreeObjectives};
  const Setting standard{"real_time", kDefaultProfile};
  const double batch = median(planTimes(scene, three, kVehicles, false));
  const double batch_default = median(planTimes(scene, standard, kVehicles, false));
  const double singles = singlesTime(scene, three);
  figures.push_back({"planner_eight_cbvs_cached_p50", batch, "ms", "<=25"});
  figures.push_back({"planner_eight_cbvs_cached_default_profile_p50", batch_default, "ms", ""});
  figures.push_back({"planner_eight_singles_cached_p50", singles, "ms", ""});
  figures.push_back({"planner_eight_in_batch_per_eight_singles", batch / singles, "", "<=0.75"});
}

/// Images included, 1 to 64 vehicles in one call: each decision and what it costs per single one.
void addMany(Figures& figures, std::int64_t threads, const std::string& suffix,
             const std::map<int, std::string>& goals) {
  constexpr int kMost = 64;
  constexpr int kTimed = 480;  // vehicles, in 8 to 60 decisions
  const Setting single{"real_time", kThreeObjectives};
  const Setting setting{"real_time", kThreeObjectives, "auto", threads};
  DecisionScene scene("", 0, "", kMost);
  const double one = median(planTimes(scene, single, 1, true));
  for (const auto& [count, goal] : goals) {
    const int decisions = kFirstDecisions + std::min(kDecisions, std::max(8, kTimed / count));
    const double time = median(planTimes(scene, setting, count, true, decisions));
    const std::string name = "planner_" + std::to_string(count) + "_cbvs" + suffix;
    figures.push_back({name + "_p50", time, "ms", ""});
    figures.push_back({name + "_per_one", time / one, "times", goal});
  }
}

}  // namespace

void benchmarkPlanner(Figures& figures) {
  DecisionScene scene;
  const double encoder_p95 = addNetworks(figures);
  addPrecisions(figures, scene);
  addSingles(figures, scene, encoder_p95);
  addBatch(figures, scene);
  addMany(figures, 1, "", {{1, ""}, {8, "<=8"}, {16, ""}, {32, ""}, {64, "<=52"}});
  addMany(figures, 2, "_two_threads", {{1, ""}, {8, "<=4.5"}, {16, ""}, {32, ""}, {64, "<=28"}});
  addEager(figures, scene);
}

}  // namespace cdiff::benchmark

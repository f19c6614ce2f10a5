// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/sampler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "diffusion/few_step_solver.h"
#include "diffusion/sampling_batch.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::diffusion {
namespace {

using traffic::kActionColumns;
using traffic::kRolloutColumns;
using traffic::kStateColumns;

/// alpha_bar at K and K - 1 is so small that a few-step sampler divides by almost nothing there.
constexpr int kSkippedSteps = 2;

int firstFewStep(int diffusion_steps) { return std::max(1, diffusion_steps - kSkippedSteps); }

/// One run over a batch.
class Run {
 public:
  Run(Denoiser& denoiser, StateBranch& branch, const NoiseSchedule& schedule,
      const core::RandomStream& noise, double correlation,
      const std::vector<SampleRequest>& requests)
      : denoiser_(denoiser),
        branch_(branch),
        schedule_(schedule),
        noise_(noise),
        correlation_(correlation),
        requests_(requests),
        batch_(requests.size(), denoiser.architecture().horizon),
        results_(requests.size()) {}

  /// Pure noise, or the previous plan noised to k. Its noise is that of step K + 1, which no
  /// reverse step draws.
  void start(int k, bool warm);
  void ddpm(CleanObjective* objective);
  void fewSteps(const std::vector<int>& steps, const SamplerOptions& options,
                const traffic::Rollout& spread, CleanObjective* objective);
  std::vector<SampledTrajectory> take();

 private:
  float normal(std::size_t sample, int k, std::size_t cell) const;
  bool guidesAny(const CleanObjective* objective, int k) const;
  void reverse(int k, const std::vector<float>* gradient);
  void countGuided(const CleanObjective& objective, int k, const std::vector<bool>& clipped);

  Denoiser& denoiser_;
  StateBranch& branch_;
  const NoiseSchedule& schedule_;
  const core::RandomStream& noise_;
  double correlation_;
  const std::vector<SampleRequest>& requests_;
  SamplingBatch batch_;
  std::vector<SampledTrajectory> results_;
};

float Run::normal(std::size_t sample, int k, std::size_t cell) const {
  core::RandomKey key = requests_[sample].key;
  key.diffusion_step = static_cast<std::uint16_t>(k);
  const auto element =
      static_cast<std::uint32_t>(requests_[sample].candidate * batch_.cells() + cell);
  if (correlation_ == 0.0) return static_cast<float>(noise_.normal(key, element));
  core::RandomKey lasting = key;
  lasting.decision = std::numeric_limits<std::uint32_t>::max();  // no decision has this tick
  return static_cast<float>(std::sqrt(correlation_) * noise_.normal(lasting, element) +
                            std::sqrt(1.0 - correlation_) * noise_.normal(key, element));
}

void Run::start(int k, bool warm) {
  const auto signal = static_cast<float>(std::sqrt(schedule_.alphaBar(k)));
  const auto sigma = static_cast<float>(std::sqrt(1.0 - schedule_.alphaBar(k)));
  for (std::size_t b = 0; b < batch_.count(); ++b) {
    for (std::size_t i = 0; i < batch_.cells(); ++i) {
      const float z = normal(b, schedule_.steps() + 1, i);
      batch_.noisy(b)[i] = warm ? signal * requests_[b].warm->data()[i] + sigma * z : z;
    }
  }
}

bool Run::guidesAny(const CleanObjective* objective, int k) const {
  if (objective == nullptr) return false;
  for (std::size_t b = 0; b < requests_.size(); ++b) {
    if (objective->actsAt(b, k)) return true;
  }
  return false;
}

void Run::countGuided(const CleanObjective& objective, int k, const std::vector<bool>& clipped) {
  for (std::size_t b = 0; b < results_.size(); ++b) {
    if (!objective.actsAt(b, k)) continue;
    ++results_[b].guided_steps;
    if (!clipped.empty() && clipped[b]) ++results_[b].trust_region_hits;
  }
}

/// tau^{k-1} from tau^k and the clean prediction.
void Run::reverse(int k, const std::vector<float>* gradient) {
  const auto clean_weight = static_cast<float>(schedule_.cleanWeight(k));
  const auto noisy_weight = static_cast<float>(schedule_.noisyWeight(k));
  const auto beta = static_cast<float>(schedule_.beta(k));
  const auto sigma = k > 1 ? static_cast<float>(std::sqrt(schedule_.beta(k))) : 0.0F;
  for (std::size_t b = 0; b < batch_.count(); ++b) {
    const Trajectory clean = batch_.clean(b);
    float* noisy = batch_.noisy(b);
    for (std::size_t i = 0; i < batch_.cells(); ++i) {
      float mean = clean_weight * clean.data()[i] + noisy_weight * noisy[i];
      if (gradient != nullptr) mean -= beta * (*gradient)[b * batch_.cells() + i];
      noisy[i] = sigma > 0.0F ? mean + sigma * normal(b, k, i) : mean;
    }
  }
}

void Run::ddpm(CleanObjective* objective) {
  for (int k = schedule_.steps(); k >= 1; --k) {
    batch_.predict(denoiser_, branch_, k);
    const std::vector<float>* gradient = nullptr;
    if (guidesAny(objective, k)) {
      batch_.evaluate(*objective, k);
      gradient = &batch_.noisyGradient(denoiser_, branch_);
      countGuided(*objective, k, {});
    }
    reverse(k, gradient);
  }
  // The rollout that is planned is what the states do under the guided actions.
  for (std::size_t b = 0; b < batch_.count(); ++b) {
    const Eigen::Map<const Trajectory> last(batch_.noisy(b), batch_.horizon(), kRolloutColumns);
    for (Eigen::Index t = 0; t < batch_.horizon(); ++t) {
      for (int c = 0; c < kActionColumns; ++c)
        batch_.actions(b)[t * kActionColumns + c] = last(t, kStateColumns + c);
    }
  }
  batch_.predictStates(branch_, 1);
}

/// r_k of the actions [T, 3].
std::vector<float> proximalRadius(double alpha_bar, const traffic::Rollout& spread) {
  std::vector<float> radius;
  for (Eigen::Index t = 0; t < spread.rows(); ++t) {
    for (int c = 0; c < kActionColumns; ++c) {
      const double variance = std::pow(spread(t, kStateColumns + c), 2);
      radius.push_back(static_cast<float>(
          std::sqrt(variance * (1.0 - alpha_bar) / (alpha_bar * variance + 1.0 - alpha_bar))));
    }
  }
  return radius;
}

void Run::fewSteps(const std::vector<int>& steps, const SamplerOptions& options,
                   const traffic::Rollout& spread, CleanObjective* objective) {
  const std::unique_ptr<FewStepSolver> solver = makeFewStepSolver(options.solver, schedule_);
  const ProximalOptions proximal{static_cast<int>(options.inner_iterations), options.trust_region};
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const int k = steps[i];
    batch_.predict(denoiser_, branch_, k);
    if (guidesAny(objective, k)) {
      const std::vector<float> radius = proximalRadius(schedule_.alphaBar(k), spread);
      countGuided(*objective, k, proximalStep(proximal, radius, k, branch_, *objective, batch_));
    }
    if (i + 1 < steps.size()) solver->step(k, steps[i + 1], batch_);
  }
}

std::vector<SampledTrajectory> Run::take() {
  for (std::size_t b = 0; b < batch_.count(); ++b) results_[b].clean = batch_.clean(b);
  return std::move(results_);
}

}  // namespace

void SamplerOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"mode", "", "How trajectories are denoised."}, mode,
               {"paper", "real_time", "unguided"});
  visitor.text({"solver", "", "Solver of real_time: first order, or second order of equal cost."},
               solver, fewStepSolverNames());
  visitor.integer({"steps", "", "Denoising steps of real_time, evenly spaced."}, steps, 1, 1000);
  visitor.integer({"clean_up_steps", "",
                   "Steps of real_time after these, each at half of the diffusion step before."},
                  clean_up_steps, 0, 10);
  visitor.integer({"inner_iterations", "", "Descent steps of each proximal step of real_time."},
                  inner_iterations, 1, 50);
  visitor.flag({"warm_start", "", "real_time: start from the previous plan where it still fits."},
               warm_start);
  visitor.integer({"warm_start_step", "", "Diffusion step that the previous plan is noised to."},
                  warm_start_step, 1, 1000);
  visitor.integer({"warm_steps", "", "Denoising steps of a warm start."}, warm_steps, 1, 1000);
}

namespace {

/// `count` steps evenly spaced from `first` down, the last one `first` / `count`.
std::vector<int> evenSteps(int first, int count) {
  std::vector<int> steps;
  for (int i = 0; i < count; ++i) {
    steps.push_back(
        static_cast<int>(std::lround(static_cast<double>(first) * (count - i) / count)));
  }
  return steps;
}

void requireAtMost(const char* key, std::int64_t value, int most, const std::string& why) {
  if (value <= most) return;
  throw core::InputError("key 'diffusion.sampler." + std::string(key) + "' is " +
                         std::to_string(value) + "; " + why + ", so at most " +
                         std::to_string(most) + " is expected");
}

/// Throws InputError for a key that only mode real_time heeds.
void requireRealTime(const char* key, const char* what, const std::string& mode) {
  if (mode == "real_time") return;
  throw core::InputError("key 'diffusion.sampler." + std::string(key) + "' is " + what +
                         "; only mode real_time heeds it, and mode is " + mode);
}

}  // namespace

void SamplerOptions::validate(int diffusion_steps) const {
  const std::string model =
      "the model has K = " + std::to_string(diffusion_steps) + " diffusion steps";
  requireAtMost("steps", steps, firstFewStep(diffusion_steps),
                model + " and real_time begins two below K");
  requireAtMost("warm_start_step", warm_start_step, diffusion_steps, model);
  if (warm_start) requireRealTime("warm_start", "on", mode);
  if (solver != SamplerOptions().solver) requireRealTime("solver", solver.c_str(), mode);
  const bool clean_up_asked = clean_up_steps != SamplerOptions().clean_up_steps;
  if (clean_up_asked)
    requireRealTime("clean_up_steps", std::to_string(clean_up_steps).c_str(), mode);
  if (warm_steps > warm_start_step) {
    throw core::InputError("key 'diffusion.sampler.warm_steps' is " + std::to_string(warm_steps) +
                           "; expected at most warm_start_step (" +
                           std::to_string(warm_start_step) + ")");
  }
  for (const bool warm : {false, true}) {
    if (mode != "real_time" || !clean_up_asked || (warm && !warm_start)) continue;
    const std::vector<int> visited = visitedSteps(diffusion_steps, warm);
    const auto even = static_cast<std::size_t>(warm ? warm_steps : steps);
    const auto halved = static_cast<int>(std::log2(visited[even - 1]));
    requireAtMost("clean_up_steps", clean_up_steps, halved,
                  "the steps before end at " + std::to_string(visited[even - 1]) +
                      ", which can be halved " + std::to_string(halved) + " times");
  }
}

std::vector<int> SamplerOptions::visitedSteps(int diffusion_steps, bool warm) const {
  if (mode != "real_time") return evenSteps(diffusion_steps, diffusion_steps);
  const int first = warm ? static_cast<int>(warm_start_step) : firstFewStep(diffusion_steps);
  std::vector<int> visited =
      evenSteps(first, std::min(first, static_cast<int>(warm ? warm_steps : steps)));
  for (std::int64_t i = 0; i < clean_up_steps && visited.back() > 1; ++i)
    visited.push_back(visited.back() / 2);
  return visited;
}

Sampler::Sampler(const SamplerOptions& options, const NoiseSchedule& schedule,
                 const traffic::Rollout& spread, const core::RandomStream& noise)
    : options_(options), schedule_(schedule), spread_(spread), noise_(noise) {
  options_.validate(schedule.steps());
}

std::vector<SampledTrajectory> Sampler::sample(Denoiser& denoiser, StateBranch& states,
                                               const std::vector<SampleRequest>& requests,
                                               CleanObjective* objective) const {
  if (requests.empty()) return {};
  for (const SampleRequest& request : requests) {
    if ((request.warm == nullptr) != (requests.front().warm == nullptr))
      throw std::invalid_argument("a batch holds cold starts only or warm starts only");
  }
  Run run(denoiser, states, schedule_, noise_, options_.noise_correlation, requests);
  const bool warm = options_.mode == "real_time" && requests.front().warm != nullptr;
  const std::vector<int> steps = visitedSteps(warm);
  run.start(steps.front(), warm);
  if (options_.mode == "real_time")
    run.fewSteps(steps, options_, spread_, objective);
  else
    run.ddpm(options_.mode == "unguided" ? nullptr : objective);
  return run.take();
}

}  // namespace cdiff::diffusion

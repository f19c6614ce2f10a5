// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/few_step_solver.h"

#include <cmath>
#include <stdexcept>

namespace cdiff::diffusion {
namespace {

/// Share of the clean trajectory and of the noise in tau^k.
struct Levels {
  Levels(const NoiseSchedule& schedule, int k)
      : signal(std::sqrt(schedule.alphaBar(k))), sigma(std::sqrt(1.0 - schedule.alphaBar(k))) {}
  double lambda() const { return std::log(signal / sigma); }

  double signal;
  double sigma;
};

class Ddim : public FewStepSolver {
 public:
  explicit Ddim(const NoiseSchedule& schedule) : schedule_(schedule) {}

  void step(int from, int to, SamplingBatch& batch) override {
    const Levels now(schedule_, from);
    const Levels next(schedule_, to);
    for (std::size_t b = 0; b < batch.count(); ++b) {
      const Trajectory clean = batch.clean(b);
      float* noisy = batch.noisy(b);
      for (std::size_t i = 0; i < batch.cells(); ++i) {
        const double x = clean.data()[i];
        const double epsilon = (noisy[i] - now.signal * x) / now.sigma;
        noisy[i] = static_cast<float>(next.signal * x + next.sigma * epsilon);
      }
    }
  }

 private:
  const NoiseSchedule& schedule_;
};

class Dpmpp2m : public FewStepSolver {
 public:
  explicit Dpmpp2m(const NoiseSchedule& schedule) : schedule_(schedule) {}

  void step(int from, int to, SamplingBatch& batch) override {
    const Levels now(schedule_, from);
    const Levels next(schedule_, to);
    const double h = next.lambda() - now.lambda();
    const bool first = last_clean_.empty();
    const double slope = first ? 0.0 : h / (2.0 * last_h_);
    if (first) last_clean_.resize(batch.count() * batch.cells());
    for (std::size_t b = 0; b < batch.count(); ++b) {
      const Trajectory clean = batch.clean(b);
      float* noisy = batch.noisy(b);
      float* last = last_clean_.data() + b * batch.cells();
      for (std::size_t i = 0; i < batch.cells(); ++i) {
        const double x = clean.data()[i];
        const double data = first ? x : x + slope * (x - last[i]);
        noisy[i] = static_cast<float>(next.sigma / now.sigma * noisy[i] -
                                      next.signal * std::expm1(-h) * data);
        last[i] = clean.data()[i];
      }
    }
    last_h_ = h;
  }

 private:
  const NoiseSchedule& schedule_;
  std::vector<float> last_clean_;  ///< [B, T, 7] guided clean prediction of the step before
  double last_h_ = 0.0;            ///< of the step before
};

template <class Solver>
std::unique_ptr<FewStepSolver> make(const NoiseSchedule& schedule) {
  return std::make_unique<Solver>(schedule);
}

/// One row per solver: everything that is known of it.
struct SolverRow {
  const char* name;
  const char* title;
  std::unique_ptr<FewStepSolver> (*make)(const NoiseSchedule&);
};

constexpr SolverRow kSolvers[] = {{"ddim", "DDIM", make<Ddim>},
                                  {"dpmpp_2m", "DPM-Solver++(2M)", make<Dpmpp2m>}};

const SolverRow& solverNamed(const std::string& name) {
  for (const SolverRow& row : kSolvers) {
    if (name == row.name) return row;
  }
  throw std::invalid_argument("no few-step solver is named '" + name + "'");
}

}  // namespace

std::vector<std::string> fewStepSolverNames() {
  std::vector<std::string> names;
  for (const SolverRow& row : kSolvers) names.emplace_back(row.name);
  return names;
}

std::string fewStepSolverTitle(const std::string& name) { return solverNamed(name).title; }

std::unique_ptr<FewStepSolver> makeFewStepSolver(const std::string& name,
                                                 const NoiseSchedule& schedule) {
  return solverNamed(name).make(schedule);
}

}  // namespace cdiff::diffusion

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <mutex>
#include <set>

#include "planners/diffusion/diffusion_workers.h"
#include "support/random_model.h"

namespace cdiff::planners {
namespace {

TEST(DiffusionWorkers, DivideItemsAmongThemselves) {
  DiffusionOptions options;
  options.threads = 3;
  const diffusion::Model model = cdiff::testing::randomModel();
  DiffusionWorkers workers(options, model, false);
  const auto sharesOf = [&](std::size_t count) {
    std::mutex mutex;
    std::set<std::pair<std::size_t, std::size_t>> shares;
    std::set<Worker*> asked;
    workers.forEach(count, [&](Worker& worker, std::size_t begin, std::size_t end) {
      const std::lock_guard<std::mutex> lock(mutex);
      shares.emplace(begin, end);
      EXPECT_TRUE(asked.insert(&worker).second) << "one thread each";
    });
    return shares;
  };
  using Shares = std::set<std::pair<std::size_t, std::size_t>>;
  EXPECT_EQ(sharesOf(7), (Shares{{0, 2}, {2, 4}, {4, 7}}));
  EXPECT_EQ(sharesOf(2), (Shares{{0, 1}, {1, 2}})) << "more workers than items";
  EXPECT_EQ(sharesOf(0), Shares{});
}

TEST(Worker, MixesPredictionsWhereTheRouteIsScaled) {
  const diffusion::Model model = cdiff::testing::randomModel();
  Worker plain({}, model, false, 0);
  Worker scaled({}, model, true, 1);
  EXPECT_EQ(dynamic_cast<diffusion::RouteScaledDenoiser*>(&plain.denoiser(true)), nullptr);
  EXPECT_NE(dynamic_cast<diffusion::RouteScaledDenoiser*>(&scaled.denoiser(true)), nullptr);
  EXPECT_EQ(dynamic_cast<diffusion::RouteScaledDenoiser*>(&scaled.denoiser(false)), nullptr);
}

}  // namespace
}  // namespace cdiff::planners

// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "e2e_cdiff/core/random.h"
#include "evaluation/search/search_space.h"

namespace cdiff::evaluation {

/// A case that has been run: where it lies in the space, and how bad it was for the ego.
struct RatedPoint {
  SearchPoint point;
  double score = 0.0;  ///< higher is worse for the ego
};

/// Proposes the points of a search. Each is a function of seed, number of the case and the rated
/// cases alone, so a search that is resumed proposes the same ones. Method random draws each point
/// evenly. Method evolution draws the first `draws` cases and the share `fresh` of the later ones
/// likewise. Every other case mixes two of the `elite` worst cases and changes some of its keys: a
/// number by a normal step, reflected at the bounds, a level by a new draw.
class SearchProposal {
 public:
  /// Both must outlive the object.
  SearchProposal(const SearchOptions& options, const SearchSpace& space, std::uint64_t seed)
      : options_(options), space_(space), stream_(seed, "search") {}

  /// Of case `number`, counted from 0. `attempt`: another one of the same case, where a proposal
  /// was there before.
  SearchPoint point(std::size_t number, const std::vector<RatedPoint>& rated,
                    std::size_t attempt = 0) const;

 private:
  SearchPoint drawn(const core::RandomKey& key) const;
  SearchPoint bred(const core::RandomKey& key, const std::vector<RatedPoint>& rated) const;
  double changed(const core::RandomKey& key, std::size_t index, double place) const;

  const SearchOptions& options_;
  const SearchSpace& space_;
  core::RandomStream stream_;
};

}  // namespace cdiff::evaluation

// SPDX-License-Identifier: BSD-3-Clause
// What a trusted skin is told of its cells.
#pragma once

#include <span>
#include <vector>

#include "skinctl/sensing/cell_health.hpp"
#include "skinctl/sensing/life_settings.hpp"
#include "skinctl/sensing/rest_level.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Settings of a `TrustedSkin`. The defaults are for TUM's cells at 250 Hz.
struct TrustSettings {
  /// Lone force of each cell [N], or one for all: the largest push that counts while no witness is touched,
  /// too. `lone_forces` gives what the arm's Coulomb friction holds. Required: 0 mutes a lone cell, infinity
  /// trusts it.
  std::vector<double> lone_force;
  std::vector<SensorNoise> noise{SensorNoise{}};  ///< noise of each cell, or one for all
  /// Sampling period of a cell that sends all readings; the shortest one of a cell that sends only changes.
  Nanoseconds period = 4ms;
  /// Whether the cells have a proximity sensor that is a witness, and evidence that a frozen cell drifts.
  /// False: its readings count, but say nothing of forces.
  bool proximity = true;
  Nanoseconds seen_for = 25ms;   ///< time of a proximity above 0.1, without a jump, that makes a witness
  double witness_share = 0.1;    ///< share of a cell's force that a neighbour has to feel to be its witness
  double other_proximity = 0.3;  ///< proximity of a neighbour from which on it is a witness
  double max_unexplained =
      0.05;  ///< largest share of a cell's changes that its cross-talk leaves unexplained
  double max_unexplained_far =
      0.25;  ///< value of `max_unexplained` for a cell whose own proximity is below 0.05
  CellHealthSettings health;
  LifeSettings life;
  RestSettings rest;
  double spread = 0.07;     ///< share of a push on the middle of a cell that each neighbour feels
  bool find_faults = true;  ///< whether faults are found; false: no cell is masked
  bool follow_rest = true;  ///< false: readings have no drift, their rest levels stay those of `noise`

  /// Throws `ConfigurationError` for a number out of its range, and for lists that do not have one entry or
  /// one for each of `cells`.
  SKINCTL_COLD void check(std::size_t cells) const {
    health.check(), life.check();
    require(lone_force.size() == 1 || lone_force.size() == cells, "TrustSettings: lone_force",
            double(lone_force.size()), "one for all cells, or one a cell: see lone_forces()");
    for (const double f : lone_force) require(f >= 0, "TrustSettings: lone_force", f, ">= 0 N");
    require(noise.size() == 1 || noise.size() == cells, "TrustSettings: noise", double(noise.size()),
            "one for all cells, or one a cell");
    require(period >= 100us && period <= 50ms, "TrustSettings: period", milliseconds(period), "0.1 to 50 ms");
    require(seen_for >= 0ns && seen_for <= 1s, "TrustSettings: seen_for", milliseconds(seen_for),
            "0 to 1000 ms");
    require(spread > 0 && spread <= 1, "TrustSettings: spread", spread, "> 0, <= 1");
    const auto share = [](double x, const char* name) { require(x >= 0 && x <= 1, name, x, "0 to 1"); };
    share(witness_share, "TrustSettings: witness_share"),
        share(other_proximity, "TrustSettings: other_proximity");
    share(max_unexplained, "TrustSettings: max_unexplained"),
        share(max_unexplained_far, "TrustSettings: max_unexplained_far");
  }
};

SKINCTL_END_NAMESPACE

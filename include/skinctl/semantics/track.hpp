// SPDX-License-Identifier: BSD-3-Clause
// A thing that a detector saw and did not number: what was seen, the place, and the numbers of its belief.
#pragma once

#include "skinctl/semantics/world.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A detection of a thing by its class: the detector cannot tell things of one class apart.
template <Real T = double>
struct ClassDetection {
  Xyz<T> p_W{T(0), T(0), T(0)};  ///< place of the thing in the world [m]
  T sigma = T(0.005);            ///< standard deviation of the place along each axis [m], 1e-6 to 100
  ObjectClass kind = 0;          ///< class of the thing; 0: none
};

/// A place at which something was seen, and the belief that it is there: log odds `sight + touch`.
template <Real T = double>
struct Track {
  Xyz<T> p{T(0), T(0), T(0)};        ///< place in the world [m]
  Xyz<T> touched{T(0), T(0), T(0)};  ///< value of `p` when a take at this track failed last [m]
  T sigma = T(0);                    ///< standard deviation of `p` along each axis [m]
  T sight = T(0);                    ///< log odds that the thing is there, by pictures
  T touch = T(0);                    ///< change of the log odds by failed takes, <= 0
  Nanoseconds seen{};                ///< time of the newest picture that showed the thing
  ObjectClass kind = 0;              ///< class by majority; 0: the place in the memory is free
  std::uint8_t votes = 0;            ///< pictures that showed class `kind`, less those that showed others
  std::uint8_t fails = 0;            ///< number of takes that failed at this track
  bool real = false;                 ///< a failed take touched or moved the thing: it is no ghost
};

/// Settings of `Tracks`. Their values for a certain detector and gripper are measured with these.
template <Real T = double>
struct TrackSettings {
  T random_walk = T(0.002);   ///< random walk of things that nobody moves [m/sqrt(s)]; as ObjectWorld's
  T max_deviations = T(4);    ///< radius of the association, in deviations; 1 detection in 900 is further off
  T seen_if_there = T(0.95);  ///< share of the pictures in which a thing that is there is detected
  T seen_if_not = T(0.2);     ///< share of the pictures in which a ghost is detected; large, as a ghost stays
  T thing_prior =
      T(0.05);  ///< prior probability of a thing at a new place; by pictures alone at most 1 less it
  Nanoseconds keep_doubted = 2s;  ///< time for which an unseen track with failed takes stays: 60 pictures
  T prior_successes = T(9),
    prior_failures = T(1);  ///< prior counts of takes of real things, Beta(9, 1): 9 of 10 takes succeed
  T min_motion = T(0.02);   ///< smallest motion of a thing that is no ghost [m]: 4 sigma of a detection
  T bias_step = T(0.018);   ///< step of the search for the bias [m]: fingers open 17 mm wider on each side
  std::uint8_t places = 2;  ///< number of places with missed real things from which on camera or hand errs
  std::uint8_t takes = 3;   ///< number of successes in a row that set the count for `places` to 0
  std::uint8_t max_empty_takes =
      6;  ///< number of takes without contact that decide a try: more than there are ghosts
};

SKINCTL_END_NAMESPACE

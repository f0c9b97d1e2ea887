// SPDX-License-Identifier: BSD-3-Clause
// A thing that a detector saw and did not number: what was seen, the place, and the numbers of its belief.
#pragma once

#include "skinctl/semantics/world.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A detector saw a thing of a class: which one of them it was, it cannot tell.
template <Real T = double>
struct ClassDetection {
  Xyz<T> p_W{T(0), T(0), T(0)};  ///< place of the thing in the world [m]
  T sigma = T(0.005);            ///< deviation of the place along each axis [m], 1e-6 to 100
  ObjectClass kind = 0;          ///< class of the thing; 0: none
};

/// A place at which something was seen, and the belief that it is there: log odds `sight + touch`.
template <Real T = double>
struct Track {
  Xyz<T> p{T(0), T(0), T(0)};        ///< place in the world [m]
  Xyz<T> touched{T(0), T(0), T(0)};  ///< position of the track when a hand found nothing there [m]
  T sigma = T(0);                    ///< deviation of `p` along each axis [m]
  T sight = T(0);                    ///< log odds by pictures
  T touch = T(0);                    ///< log odds by failed takes, <= 0
  Nanoseconds seen{};                ///< picture that showed it last
  ObjectClass kind = 0;              ///< class by majority; 0: the place in the memory is free
  std::uint8_t votes = 0;            ///< pictures of this class, less those of others
  std::uint8_t fails = 0;            ///< takes that failed here
  bool real = false;                 ///< a take that failed touched or moved it
};

/// Numbers of tracks. What they hold for a certain detector and gripper is measured there.
template <Real T = double>
struct TrackSettings {
  T wander = T(0.002);        ///< deviation of what things move on their own [m/sqrt(s)]; as ObjectWorld's
  T max_deviations = T(4);    ///< radius of the association; 1 detection in 900 is further off in three axes
  T seen_if_there = T(0.95);  ///< share of the pictures in which a thing that is there is detected
  T seen_if_not = T(0.2);     ///< chance to see what is not there: far above flashes, as a ghost stays
  T things = T(0.05);  ///< share of things among unseen places, of nothing among those always seen: a guess
  Nanoseconds doubted = 2s;  ///< a place where takes failed is kept this long without being seen: 60 pictures
  T taken = T(9), failed = T(1);  ///< prior of takes, Beta(9, 1): 9 of 10 takes of real things succeed
  T moved = T(0.02);        ///< a thing that moved by more than this is no ghost [m]: 4 sigma of a detection
  T beside = T(0.018);      ///< step of the search for the bias [m]: fingers open 17 mm wider on each side
  std::uint8_t places = 2;  ///< places where a real thing is missed, before ...
  std::uint8_t takes = 3;   ///< ... takes that succeed, are a fault of camera or hand, not of the places
  std::uint8_t empty = 6;   ///< takes without contact that decide a try: more than there are ghosts
};

SKINCTL_END_NAMESPACE

// SPDX-License-Identifier: BSD-3-Clause
// The objects around a robot: where stamped detections, and the hand that holds one, say they are.
#pragma once

#include <array>
#include <cstddef>
#include <type_traits>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/detail/plausible.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/frames/transform.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The frame of an object, as its detector places it.
struct ObjectFrame : FrameTag {};
/// The pose of an object in the frame `W`.
template <Frame W = World>
using ObjectPose = Transform<W, ObjectFrame>;

/// The class of an object: a number that the application gives to "orange", "knife", "box".
using ObjectClass = std::uint8_t;

/// The number of an object that means: no object.
inline constexpr std::uint8_t no_object = 255;

/// An object was seen: a pose, the deviation of its position, and the instant at which the picture was taken
/// (not when it arrived).
template <Frame W = World>
struct Detection {
  std::uint8_t object = no_object;  ///< number of the object in the world
  ObjectPose<W> X_WO{};
  double sigma = 0.005;  ///< standard deviation of the position along each axis [m], > 0
  Nanoseconds time{};
};

/// The state of an object as far as it is known.
template <Frame W = World>
struct Object {
  ObjectPose<W> X_WO{};
  double sigma = 0;    ///< standard deviation of the position along each axis [m]
  Nanoseconds time{};  ///< time of the newest detection
  ObjectClass kind = 0;
  std::uint8_t misses = 0;  ///< number of detections in a row that were far from `X_WO`
  bool known = false;       ///< the object has a place
};

/// Settings of a world of objects.
struct ObjectWorldSettings {
  double random_walk = 0.002;   ///< random walk of objects that nobody holds [m/sqrt(s)]
  double max_deviations = 4;    ///< number of deviations, along any axis, beyond which a detection is a miss
  std::uint8_t max_misses = 3;  ///< misses in a row after which the object's place is that of the newest one
  double lost_distance = 0.10;  ///< distance from its place in the hand at which a held object is missed [m]
};

/// Objects of the world `W`, at most `Capacity` of them, numbered from 0.
///
/// Each has the weighted mean of its detections (a Kalman filter of a place that wanders slowly). An object
/// that is moved is found at its new place after `max_misses` detections. An object not seen keeps its
/// place. One that is held moves with the hand; the camera, late and half blind then, only decides whether it
/// is still there.
///
/// Immutable; what changes is a `Memory`, trivially copyable.
template <std::size_t Capacity, Frame W = World>
class ObjectWorld {
  static_assert(Capacity > 0 && Capacity < no_object, "1 to 254 objects");

 public:
  static constexpr std::size_t capacity = Capacity;
  struct Memory {
    std::array<Object<W>, Capacity> objects{};
    Transform<Tool, ObjectFrame> X_HO{};  ///< pose of the held object in the hand
    std::uint8_t held = no_object;
    std::uint8_t slipped = no_object;  ///< the last object that was found elsewhere while it was held
  };

  /// @param kinds  the class of each object. Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD explicit ObjectWorld(const std::array<ObjectClass, Capacity>& kinds,
                                    const ObjectWorldSettings& settings = {})
      : kinds_(kinds), s_(settings) {
    require(s_.random_walk > 0 && s_.random_walk <= 10, "ObjectWorld: random_walk", s_.random_walk,
            "> 0, <= 10 m/sqrt(s)");
    require(s_.max_deviations >= 1 && s_.max_deviations <= 100, "ObjectWorld: max_deviations",
            s_.max_deviations, "1 to 100 deviations");
    require(s_.max_misses >= 1 && s_.max_misses <= 100, "ObjectWorld: max_misses", s_.max_misses, "1 to 100");
    require(s_.lost_distance > 0 && s_.lost_distance <= 10, "ObjectWorld: lost_distance", s_.lost_distance,
            "> 0, <= 10 m");
  }
  [[nodiscard]] Memory start() const noexcept {
    Memory m{};
    for (std::size_t i = 0; i < Capacity; ++i) m.objects[i].kind = kinds_[i];
    return m;
  }

  /// Takes a detection. An unknown number: `sample_unknown`; a pose, deviation or stamp that is none:
  /// `sample_not_finite`; one older than the object's last: `time_backwards`. These change nothing.
  Status detect(Memory& m, const Detection<W>& d) const noexcept {
    if (d.object >= Capacity) return Reason::sample_unknown;
    if (!is_pose(d.X_WO) || !(d.sigma > 0 && d.sigma <= 100) || !detail::is_plausible(d.time))
      return Reason::sample_not_finite;
    Object<W>& o = m.objects[d.object];
    if (o.known && d.time <= o.time) return Reason::time_backwards;
    const Xyz<double> off = d.X_WO.origin() - o.X_WO.origin();
    if (m.held == d.object) {
      const bool elsewhere = norm(off) > s_.lost_distance + s_.max_deviations * d.sigma;
      o.time = d.time;
      o.misses = elsewhere ? static_cast<std::uint8_t>(o.misses + 1) : std::uint8_t(0);
      if (o.misses < s_.max_misses) return {};
      m.held = no_object;
      m.slipped = d.object;
      place(o, d);
      return {};
    }
    if (!o.known) {
      place(o, d);
      return {};
    }
    const double older =
        o.sigma * o.sigma + s_.random_walk * s_.random_walk * seconds<double>(d.time - o.time);
    const double theirs = d.sigma * d.sigma, far = s_.max_deviations * s_.max_deviations * (older + theirs);
    o.time = d.time;
    if (off.x * off.x > far || off.y * off.y > far || off.z * off.z > far) {
      o.misses = static_cast<std::uint8_t>(o.misses + 1);
      if (o.misses >= s_.max_misses) place(o, d);
      return {};
    }
    o.misses = 0;
    const double share = older / (older + theirs);
    o.sigma = std::sqrt(share * theirs);
    const Xyz<double> turn = share * log_so3(o.X_WO.axes().transpose() * d.X_WO.axes());
    o.X_WO = ObjectPose<W>::trusted(normalised(o.X_WO.axes() * exp_so3(turn)), o.X_WO.origin() + share * off);
    return {};
  }

  /// Reports that the hand at `X_WH` holds the object from now on. An object without a place is placed at
  /// the hand.
  void grasp(Memory& m, std::uint8_t object, const Transform<W, Tool>& X_WH) const noexcept {
    if (object >= Capacity) return;
    Object<W>& o = m.objects[object];
    if (!o.known) o.X_WO = ObjectPose<W>::trusted(X_WH.axes(), X_WH.origin());
    o.known = true;
    o.misses = 0;
    m.held = object;
    m.slipped = no_object;
    m.X_HO = X_WH.inverse() * o.X_WO;
  }
  /// Reports that the hand has moved to `X_WH`, and the held object with it.
  void carry(Memory& m, const Transform<W, Tool>& X_WH) const noexcept {
    if (m.held < Capacity) m.objects[m.held].X_WO = (X_WH * m.X_HO).normalised();
  }
  /// Reports that the hand lets go at `time`: the object stays where it is until a later picture shows it.
  /// `sigma` [m]: standard deviation of that place.
  void release(Memory& m, Nanoseconds time, double sigma = 0.01) const noexcept {
    if (m.held >= Capacity) return;
    Object<W>& o = m.objects[m.held];
    o.sigma = sigma > o.sigma ? sigma : o.sigma;
    o.time = time > o.time ? time : o.time;
    o.misses = 0;
    m.held = no_object;
  }

  /// An object near a point; `no_object` if there is none.
  struct Near {
    std::uint8_t object = no_object;
    double distance = 1e9;  ///< distance of the object's origin from the point [m]
  };
  /// The known object nearest to the point `p_W` other than `except`; `no_object` if there is none within
  /// `reach` [m].
  [[nodiscard]] Near nearest(const Memory& m, const Xyz<double>& p_W, double reach = 1e9,
                             std::uint8_t except = no_object) const noexcept {
    Near best{no_object, reach};
    for (std::size_t i = 0; i < Capacity; ++i) {
      if (i == except || !m.objects[i].known) continue;
      const double d = norm(Xyz<double>(m.objects[i].X_WO.origin() - p_W));
      if (d < best.distance) best = {static_cast<std::uint8_t>(i), d};
    }
    return best;
  }

 private:
  static void place(Object<W>& o, const Detection<W>& d) noexcept {
    o.X_WO = d.X_WO;
    o.sigma = d.sigma;
    o.time = d.time;
    o.known = true;
    o.misses = 0;
  }
  [[nodiscard]] static bool is_pose(const ObjectPose<W>& X) noexcept {
    const auto& p = X.origin();
    return rotation_error(X.axes()) <= 1e-6 && p.x * p.x + p.y * p.y + p.z * p.z <= 1e12;
  }

  std::array<ObjectClass, Capacity> kinds_;
  ObjectWorldSettings s_;
};

SKINCTL_END_NAMESPACE

// SPDX-License-Identifier: BSD-3-Clause
// The distances of a robot's links from each other and from known objects.
#pragma once

#include <vector>

#include "skinctl/clearance/surroundings.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/kinematics/summed_motion.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Two capsules that must not touch, by their indices in `Clearance::capsules`.
struct CapsulePair {
  std::size_t a = 0, b = 0;
};

/// Capsules, and which of them stay clear of each other: a part of `Cycle::with` (see `ClearanceLimits`).
struct Clearance {
  using Kind = Clearance;
  std::vector<LinkCapsule> capsules = {};
  std::vector<CapsulePair> pairs = {};
  double margin = 0.02;  ///< smallest distance of the surfaces that is kept [m]
  double reach = 1.5;    ///< largest distance of a capsule's point from any axis that turns it [m]
};

/// A `Clearance` whose robot also stays clear of up to `Most` obstacles that the cycle's input names anew
/// each time: what other robots occupy, what its skin sees. A part of `Cycle::with`.
///
/// Without news the robot does not move blindly: with obstacles older than `max_age`, with more of them than
/// `Most` or with one that is no number it brakes and stands.
template <std::size_t Most>
struct ClearanceAround {
  using Kind = Clearance;
  Clearance own;  ///< capsules of links and of fixed objects, and their pairs
  std::vector<std::size_t>
      exposed;  ///< the capsules of `own`, by their indices, that obstacles must not meet
  /// Two delays together: from a command until the robot is where it says, and from a change of the world
  /// until the input has it.
  Nanoseconds late = 20ms;
  Nanoseconds max_age = 100ms;  ///< largest age of the input's obstacles at the end of the cycle
};

/// The distances of the pairs of a `Clearance` at a position, and their gradients; with `Around` > 0 also
/// those of exposed capsules from that many obstacles at most, after the pairs. Immutable.
template <RobotModel M, Real T = double, std::size_t Around = 0>
class Clearances {
 public:
  static constexpr std::size_t joints = M::joints;
  static constexpr std::size_t max_exposed = Around > 0 ? max_exposed_capsules : 0;
  static constexpr std::size_t max_own = 64, max_pairs = max_own + max_exposed * Around;
  using Position = JointPosition<joints, T>;
  using Near = std::conditional_t<(Around > 0), Surroundings<Around, Base, T>, NoSurroundings>;

  /// Throws `ConfigurationError` for numbers out of their range, more than 64 pairs, pairs of one link and
  /// pairs of two objects that do not move.
  SKINCTL_COLD Clearances(const M& model, const Clearance& given) : model_(model) {
    require(given.margin >= 0 && given.margin <= 10, "Clearance: margin", given.margin, "0 to 10 m");
    require(given.reach > 0 && given.reach <= 100, "Clearance: reach", given.reach, "> 0, <= 100 m");
    require(given.pairs.size() <= max_own, "Clearance: pairs", double(given.pairs.size()), "at most 64");
    for (const CapsulePair& p : given.pairs) {
      const std::size_t count = given.capsules.size();
      require(p.a < count && p.b < count, "Clearance: capsule of a pair", double(p.a < count ? p.b : p.a),
              "one of the list");
      const LinkCapsule &a = given.capsules[p.a], &b = given.capsules[p.b];
      a.check(joints), b.check(joints);
      require(a.link != b.link, "Clearance: link of both capsules", double(a.link), "two links");
      pairs_.push_back({a.link, b.link, path(a.link) ^ path(b.link), converted(a.shape), converted(b.shape)});
    }
  }
  /// Clearances with the distances of the capsules `exposed`, indices in `given`, from obstacles, too. Throws
  /// also for more than 12 of them, for one that is not of the list, and for one that is fixed.
  SKINCTL_COLD Clearances(const M& model, const Clearance& given, const std::vector<std::size_t>& exposed)
      : Clearances(model, given) {
    require(exposed.size() <= max_exposed, "ClearanceAround: exposed capsules", double(exposed.size()),
            "at most 12");
    for (const std::size_t e : exposed) {
      require(e < given.capsules.size(), "ClearanceAround: exposed capsule", double(e), "one of the list");
      const LinkCapsule& c = given.capsules[e];
      c.check(joints);
      require(c.link != LinkCapsule::fixed, "ClearanceAround: exposed capsule", double(e), "one of a link");
      exposed_.push_back({c.link, path(c.link), converted(c.shape)});
    }
  }
  [[nodiscard]] const M& model() const noexcept { return model_; }
  /// The number of the robot's own pairs.
  [[nodiscard]] std::size_t size() const noexcept { return pairs_.size(); }
  /// The number of all pairs, those of exposed capsules with the obstacles `near` included.
  [[nodiscard]] std::size_t size(const Near& near) const noexcept {
    return pairs_.size() + exposed_.size() * count(near);
  }
  /// The joints that move the two sides of pair `k` against each other.
  [[nodiscard]] SKINCTL_INLINE LinkMask between(std::size_t k, const Near& near = {}) const noexcept {
    if constexpr (Around > 0) {
      if (k >= pairs_.size()) return exposed_[(k - pairs_.size()) / count(near)].between;
    }
    return pairs_[k].between;
  }
  /// The largest speed at which the other side of pair `k` may come closer by itself [m/s].
  [[nodiscard]] SKINCTL_INLINE T approach(std::size_t k, const Near& near) const noexcept {
    if constexpr (Around > 0) {
      if (k >= pairs_.size()) return near.obstacles[(k - pairs_.size()) % count(near)].approach;
    }
    return T(0);
  }

  /// Writes the distances of the surfaces at `q` [m] into `out`, negative where they overlap.
  SKINCTL_INLINE void distances(const Position& q, T (&out)[max_pairs]) const noexcept {
    distances(q, {}, out, [](std::size_t) { return true; });
  }
  /// Writes the distances [m] of those pairs k for which `asked(k)` is true, also from the obstacles `near`;
  /// the others are left as they are.
  template <class Asked>
  SKINCTL_NOINLINE void distances(const Position& q, const Near& near, T (&out)[max_pairs],
                                  const Asked& asked) const noexcept {
    const Placed placed(model_, q);
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      if (!asked(k)) continue;
      const Pair& p = pairs_[k];
      out[k] = skinctl::distance(placed(p.a, p.shape_a), placed(p.b, p.shape_b)).distance;
    }
    if constexpr (Around > 0) {
      std::size_t k = pairs_.size();
      for (const Exposed& e : exposed_) {
        const Capsule<T> own = placed(e.link, e.shape);
        for (std::size_t i = 0; i < count(near); ++i, ++k)
          if (asked(k)) out[k] = skinctl::distance(own, near.obstacles[i].shape).distance;
      }
    }
  }
  /// Writes the gradients of the distances at `q` [m/rad]: 0 for joints that move both sides alike.
  SKINCTL_INLINE void gradients(const Position& q, T (&gradient)[max_pairs][joints]) const noexcept {
    gradients(q, {}, gradient);
  }
  SKINCTL_NOINLINE void gradients(const Position& q, const Near& near,
                                  T (&gradient)[max_pairs][joints]) const noexcept {
    const Placed placed(model_, q);
    Columns columns[joints];
    columns_at(placed, columns);
    const auto one = [&](std::size_t a, const Capsule<T>& shape_a, std::size_t b, const Capsule<T>& shape_b,
                         LinkMask between, T(&out)[joints]) {
      using std::sqrt;
      const auto d = skinctl::distance(placed(a, shape_a), placed(b, shape_b));
      const Xyz<T> way = d.a - d.b;
      const T far = sqrt(dot(way, way));
      const Xyz<T> n = far > T(0) ? T(T(1) / far) * way : Xyz<T>{T(0), T(0), T(0)};
      for (std::size_t j = 0; j < joints; ++j) {
        T g(0);
        if ((between >> j) & 1u) {
          const auto add = [&](std::size_t link, const Xyz<T>& at, const T& sign) {
            if (link == LinkCapsule::fixed) return;
            g = g + sign * dot(n, moved(columns[link], j, at - placed.pose[link].origin()));
          };
          add(a, d.a, T(1));
          add(b, d.b, T(-1));
        }
        out[j] = g;
      }
    };
    for (std::size_t k = 0; k < pairs_.size(); ++k)
      one(pairs_[k].a, pairs_[k].shape_a, pairs_[k].b, pairs_[k].shape_b, pairs_[k].between, gradient[k]);
    if constexpr (Around > 0) {
      std::size_t k = pairs_.size();
      for (const Exposed& e : exposed_)
        for (std::size_t i = 0; i < count(near); ++i, ++k)
          one(e.link, e.shape, LinkCapsule::fixed, near.obstacles[i].shape, e.between, gradient[k]);
    }
  }
  /// Capsules, one for each exposed one, within which these stay while no joint `i` is further than `half[i]`
  /// from `q`: a point moves by `sum half_i |c_i|` and half of `SummedMotion::bend` at most.
  SKINCTL_NOINLINE void sweep(const Position& q, const Position& half, const T& reach,
                              Surroundings<max_exposed_capsules, Base, T>& out) const noexcept {
    using std::sqrt;
    const Placed placed(model_, q);
    Columns columns[joints];
    columns_at(placed, columns);
    for (const Exposed& e : exposed_) {
      Obstacle<Base, T> o{placed(e.link, e.shape), T(0)};
      T most(0);
      SummedMotion<M, T> sum;
      for (const Xyz<T>& end : {o.shape.from, o.shape.to}) {
        T way(0);
        sum = {};
        for (std::size_t j = 0; j < joints; ++j) {
          if (((e.between >> j) & 1u) == 0) continue;
          const Xyz<T> c = moved(columns[e.link], j, end - placed.pose[e.link].origin());
          way = way + half[j] * sqrt(dot(c, c)), sum.add(j, half[j]);
        }
        most = way > most ? way : most;
      }
      o.shape.radius = o.shape.radius + most + T(0.5) * sum.bend(reach);
      out.add(o);
    }
  }

 private:
  struct Columns {
    Xyz<T> linear[joints]{}, angular[joints]{};
  };
  struct Exposed {
    std::size_t link;
    LinkMask between;
    Capsule<T> shape;
  };
  /// The velocity of a point fixed to a link, at `at` from the link's origin, per velocity of joint `j`.
  [[nodiscard]] static SKINCTL_INLINE Xyz<T> moved(const Columns& c, std::size_t j,
                                                   const Xyz<T>& at) noexcept {
    return c.linear[j] + cross(c.angular[j], at);
  }
  [[nodiscard]] static SKINCTL_INLINE std::size_t count([[maybe_unused]] const Near& near) noexcept {
    if constexpr (Around > 0) {
      return near.count < Around ? near.count : Around;
    } else {
      return 0;
    }
  }
  [[nodiscard]] static Capsule<T> converted(const Capsule<>& c) noexcept {
    const auto point = [](const Xyz<double>& x) { return Xyz<T>{T(x.x), T(x.y), T(x.z)}; };
    return {point(c.from), point(c.to), T(c.radius)};
  }
  struct Pair {
    std::size_t a, b;
    LinkMask between;  ///< the joints that move one against the other
    Capsule<T> shape_a, shape_b;
  };
  [[nodiscard]] static LinkMask path(std::size_t link) noexcept {
    LinkMask mask = 0;
    if (link == LinkCapsule::fixed) return mask;
    for (int i = static_cast<int>(link); i >= 0; i = M::parents[static_cast<std::size_t>(i)])
      mask |= LinkMask(1) << i;
    return mask;
  }
  /// The links' poses, and capsules there.
  struct Placed {
    Poses<M, all_links(joints), T> poses;
    Transform<Base, Link<0>, T> pose[joints];

    Placed(const M& model, const Position& q) noexcept : poses(model, q) {
      [&]<std::size_t... Ix>(std::index_sequence<Ix...>) {
        ((pose[Ix] = poses.template get<Ix>().template renamed<Base, Link<0>>()), ...);
      }(std::make_index_sequence<joints>{});
    }
    [[nodiscard]] SKINCTL_INLINE Capsule<T> operator()(std::size_t link, const Capsule<T>& c) const noexcept {
      if (link == LinkCapsule::fixed) return c;
      const auto& X = pose[link];
      return {X.origin() + X.axes() * c.from, X.origin() + X.axes() * c.to, c.radius};
    }
  };

  template <class P>
  static SKINCTL_INLINE void columns_at(const P& placed, Columns (&columns)[joints]) noexcept {
    [&]<std::size_t... Ix>(std::index_sequence<Ix...>) {
      const auto one = [&](auto link) {
        constexpr std::size_t i = link.value;
        jacobian<i>(placed.poses).for_each([&](auto j, const auto& c) {
          columns[i].linear[j.value] = c.linear, columns[i].angular[j.value] = c.angular;
        });
      };
      (one(std::integral_constant<std::size_t, Ix>{}), ...);
    }(std::make_index_sequence<joints>{});
  }

  [[no_unique_address]] M model_;
  std::vector<Pair> pairs_;
  std::vector<Exposed> exposed_;
};

SKINCTL_END_NAMESPACE

// The distances of a robot's links from each other and from known objects.
#pragma once

#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/tactile/capsule.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Two capsules, by their numbers, that must not touch.
struct CapsulePair {
  std::size_t a = 0, b = 0;
};

/// Capsules, and which of them stay clear of each other: a part of `Cycle::with` (see `ClearanceLimits`), and of a
/// `ClearanceControl`.
struct Clearance {
  std::vector<LinkCapsule> capsules;
  std::vector<CapsulePair> pairs;
  double margin = 0.02;  ///< of the surfaces [m]
  double reach = 1.5;    ///< largest distance of a capsule's point from any joint axis before it [m]
};

/// The distances of the pairs of a `Clearance` at a position, and their gradients. Immutable.
template <RobotModel M, Real T = double>
class Clearances {
 public:
  static constexpr std::size_t joints = M::joints;
  static constexpr std::size_t most_pairs = 64;
  using Position = JointPosition<joints, T>;

  /// Throws `ConfigurationError` for numbers out of their range, more than 64 pairs, pairs of one link and pairs
  /// of two objects that do not move.
  SKINCTL_COLD Clearances(const M& model, const Clearance& given) : model_(model) {
    require(given.margin >= 0 && given.margin <= 10, "Clearance: margin", given.margin, "0 to 10 m");
    require(given.reach > 0 && given.reach <= 100, "Clearance: reach", given.reach, "> 0, <= 100 m");
    require(given.pairs.size() <= most_pairs, "Clearance: pairs", double(given.pairs.size()), "at most 64");
    for (const CapsulePair& p : given.pairs) {
      const std::size_t count = given.capsules.size();
      require(p.a < count && p.b < count, "Clearance: capsule of a pair", double(p.a < count ? p.b : p.a),
              "one of the list");
      const LinkCapsule &a = given.capsules[p.a], &b = given.capsules[p.b];
      a.check(joints), b.check(joints);
      require(a.link != b.link, "Clearance: link of both capsules", double(a.link), "two links");
      const auto convert = [](const Capsule<>& c) {
        const auto point = [](const Xyz<double>& x) { return Xyz<T>{T(x.x), T(x.y), T(x.z)}; };
        return Capsule<T>{point(c.from), point(c.to), T(c.radius)};
      };
      pairs_.push_back({a.link, b.link, path(a.link) ^ path(b.link), convert(a.shape), convert(b.shape)});
    }
  }
  [[nodiscard]] const M& model() const noexcept { return model_; }
  [[nodiscard]] std::size_t size() const noexcept { return pairs_.size(); }
  /// The joints that move the two sides of pair `k` against each other.
  [[nodiscard]] SKINCTL_INLINE LinkMask between(std::size_t k) const noexcept { return pairs_[k].between; }

  /// The distances of the surfaces at `q` [m], negative where they overlap.
  SKINCTL_NOINLINE void distances(const Position& q, T (&out)[most_pairs]) const noexcept {
    const Placed placed(model_, q);
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const Pair& p = pairs_[k];
      out[k] = skinctl::distance(placed(p.a, p.shape_a), placed(p.b, p.shape_b)).distance;
    }
  }
  /// The gradients of the distances at `q` [m/rad]: 0 for joints that move both sides alike.
  SKINCTL_NOINLINE void gradients(const Position& q, T (&gradient)[most_pairs][joints]) const noexcept {
    const Placed placed(model_, q);
    Columns columns[joints];
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      const auto one = [&](auto link) {
        constexpr std::size_t i = link.value;
        jacobian<i>(placed.poses).for_each([&](auto j, const auto& c) {
          columns[i].linear[j.value] = c.linear, columns[i].angular[j.value] = c.angular;
        });
      };
      (one(std::integral_constant<std::size_t, I>{}), ...);
    }(std::make_index_sequence<joints>{});
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      using std::sqrt;
      const Pair& p = pairs_[k];
      const auto d = skinctl::distance(placed(p.a, p.shape_a), placed(p.b, p.shape_b));
      const Xyz<T> way = d.a - d.b;
      const T far = sqrt(dot(way, way));
      const Xyz<T> n = far > T(0) ? T(T(1) / far) * way : Xyz<T>{T(0), T(0), T(0)};
      for (std::size_t j = 0; j < joints; ++j) {
        T g(0);
        if ((p.between >> j) & 1u) {
          const auto add = [&](std::size_t link, const Xyz<T>& at, const T& sign) {
            if (link == LinkCapsule::fixed) return;
            const Columns& c = columns[link];
            g = g + sign * dot(n, c.linear[j] + cross(c.angular[j], at - placed.pose[link].origin()));
          };
          add(p.a, d.a, T(1));
          add(p.b, d.b, T(-1));
        }
        gradient[k][j] = g;
      }
    }
  }

 private:
  struct Columns {
    Xyz<T> linear[joints]{}, angular[joints]{};
  };
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
      [&]<std::size_t... I>(std::index_sequence<I...>) {
        ((pose[I] = poses.template get<I>().template renamed<Base, Link<0>>()), ...);
      }(std::make_index_sequence<joints>{});
    }
    [[nodiscard]] SKINCTL_INLINE Capsule<T> operator()(std::size_t link, const Capsule<T>& c) const noexcept {
      if (link == LinkCapsule::fixed) return c;
      const auto& X = pose[link];
      return {X.origin() + X.axes() * c.from, X.origin() + X.axes() * c.to, c.radius};
    }
  };

  [[no_unique_address]] M model_;
  std::vector<Pair> pairs_;
};

SKINCTL_END_NAMESPACE

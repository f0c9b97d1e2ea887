// SPDX-License-Identifier: BSD-3-Clause
// Several fingertips hold an object between them with a given internal force.
#pragma once

#include <array>
#include <cmath>
#include <tuple>

#include "skinctl/dynamics/quantities.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Goal of a `GraspControl`: how hard the fingertips press on the object between them.
template <Scalar T = double>
struct GraspGoal {
  T internal{0};  ///< mean force of a fingertip [N]; negative: the fingers open
  /// Mean force that the contacts ask for [N]: the largest `GraspControl::force_for` of the fingertips'
  /// `Slip::Result::hold`; 0: none. The grip holds with the larger of the two, unless the fingers are to
  /// open.
  T hold{0};

  template <class F>
  friend void each_number(GraspGoal& g, F&& f) {
    f(g.internal), f(g.hold);
  }
};

/// Settings of `GraspControl`.
template <Real T = double>
struct GraspSettings {
  T damping = T(40);    ///< damping of the closing [N s/m]: free fingers close at force over damping
  T max_rate = T(20);   ///< largest rate of the force [N/s]
  T max_force = T(20);  ///< largest internal force [N]
  /// Rate at which the force falls to a `hold` [N/s]: a grip that loosens slowly slips by little.
  T lowering = T(2);
};

/// Joint torques with which fingertips on the links `Ix...` press on an object between them, and nothing
/// else:
///
///     f_i = -F (p_i - c) / s,   c = mean of p_i,   s = mean of |p_i - c|,   tau = sum J_i' f_i
///
/// The forces point at the centroid of the fingertips, in proportion to their distance from it. They add up
/// to no force and no moment on the object whatever its shape and whatever the number of fingers; so an arm,
/// gravity compensation or a touch that move the hand are not disturbed. F follows the goal at `max_rate`,
/// and `damping ds/dt` is added, which damps the closing of the fingers and nothing else. With a `hold` that
/// follows the fingertips' shear (`Slip`) the grip tightens at `max_rate`, and loosens at `lowering`.
///
/// The object stays between the fingers if the centroid sees each fingertip within its friction cone. F goes
/// to zero below 1 mm of s.
///
/// With weights w_i, f_i = -F w_i (p_i - c) / s, and c and s are weighted means: a finger of weight 0 takes
/// no part.
///
/// @tparam N  joints of the robot.  @tparam Ix  two or more links, one a finger.
template <std::size_t N, Real T, std::size_t... Ix>
class GraspControl : public Composable {
  static_assert(sizeof...(Ix) >= 2, "a grasp needs two fingertips");

 public:
  using Goal = GraspGoal<T>;
  using scalar = T;
  using Settings = GraspSettings<T>;
  static constexpr std::size_t joints = N;
  static constexpr std::size_t fingers = sizeof...(Ix);
  static constexpr Needs needs = {.jacobians = (link_bit<Ix> | ...)};
  static constexpr LawRole role = LawRole::reactive;
  static constexpr const char* name = "grasp";
  struct Memory {
    T force = T(0);  ///< internal force now [N]
    T goal = T(0);   ///< internal force of the goal [N]
    T hold = T(0);   ///< force of the goal that the contacts ask for [N]; 0: none
  };

  /// @param p_LP  the point of each fingertip that touches, in its link [m], in the order of `Ix`.
  /// @param weights  of the fingertips, 0 to 1, two of them or more > 0.
  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD explicit GraspControl(const std::array<Xyz<T>, fingers>& p_LP, const Settings& s = {},
                                     const std::array<T, fingers>& weights = all_alike())
      : weight_(weights), s_(s) {
    T sum = T(0);
    std::size_t some = 0;
    for (const T& w : weights) {
      require(w >= T(0) && w <= T(1), "GraspControl: weight of a fingertip", static_cast<double>(w),
              "0 to 1");
      sum = sum + w;
      some += w > T(0);
    }
    require(some >= 2, "GraspControl: fingertips that take part", static_cast<double>(some), ">= 2");
    for (std::size_t k = 0; k < fingers; ++k) share_[k] = weights[k] / sum;
    for (std::size_t k = 0; k < fingers; ++k) {
      require(dot(p_LP[k], p_LP[k]) <= T(1), "GraspControl: |p_LP|^2",
              static_cast<double>(dot(p_LP[k], p_LP[k])), "<= 1 m^2");
      X_LP_[k] = p_LP[k];
    }
    require(s.damping >= T(0) && s.damping <= T(1e5), "GraspControl: damping", static_cast<double>(s.damping),
            "0 to 1e5 N s/m");
    require(s.max_rate > T(0) && s.max_rate <= T(1e6), "GraspControl: max_rate",
            static_cast<double>(s.max_rate), "> 0, <= 1e6 N/s");
    require(s.max_force > T(0) && s.max_force <= T(1e4), "GraspControl: max_force",
            static_cast<double>(s.max_force), "> 0, <= 1e4 N");
    require(s.lowering > T(0) && s.lowering <= T(1e6), "GraspControl: lowering",
            static_cast<double>(s.lowering), "> 0, <= 1e6 N/s");
  }
  [[nodiscard]] const Settings& settings() const noexcept { return s_; }

  template <class K>
  [[nodiscard]] static Memory start(const K&) noexcept {
    return {};
  }
  /// Takes another force; refused if it is not finite, cut off at `max_force`.
  template <class K>
  [[nodiscard]] Received<Memory> receive(const Memory& m, const K&, const Goal& goal) const noexcept {
    if (!(goal.internal - goal.internal == T(0)) || !(goal.hold - goal.hold == T(0)))
      return {m, Reason::goal_refused};
    const T most = s_.max_force;
    return {{m.force,
             goal.internal > most    ? most
             : goal.internal < -most ? T(-most)
                                     : goal.internal,
             goal.hold > most   ? most
             : goal.hold > T(0) ? goal.hold
                                : T(0)},
            {}};
  }

  /// Places of the fingertips, their mean distance from their centroid, and its rate.
  struct Shape {
    Xyz<T> p[fingers];  ///< fingertips in the base [m]
    Xyz<T> centroid{T(0), T(0), T(0)};
    T size = T(0);  ///< mean distance of the fingertips from the centroid [m]
    T rate = T(0);  ///< rate of change of `size` [m/s]
  };
  template <class K>
  [[nodiscard]] Shape shape(const K& known) const noexcept {
    const auto X_LP = tips();
    return shape_of(known, jacobians(known, X_LP));
  }

  /// The mean force [N] at which fingertip `k` presses with `normal` [N]; 0 for one that takes no part.
  [[nodiscard]] T force_for(const Shape& shape, std::size_t k, const T& normal) const noexcept {
    const T share = weight_[k] * norm(Xyz<T>(shape.p[k] - shape.centroid));
    return share > T(1e-6) ? T(normal * shape.size / share) : T(0);
  }

  template <class K>
  [[nodiscard]] SKINCTL_INLINE JointTorque<N, T> torque(const Memory& m, const K& known) const noexcept {
    const auto X_LP = tips();  // the Jacobians refer to them
    const auto J = jacobians(known, X_LP);
    const Shape s = shape_of(known, J);
    JointTorque<N, T> tau;
    if (!(s.size > T(1e-6))) return tau;
    const T fade = s.size < T(1e-3) ? T(s.size * T(1e3)) : T(1);
    const T per = fade * (m.force + s_.damping * s.rate) / s.size;
    const auto one = [&](const auto& J_k, std::size_t k) SKINCTL_INLINE_LAMBDA {
      typename std::remove_cvref_t<decltype(J_k)>::Load F;
      F.force = T(-per * weight_[k]) * (s.p[k] - s.centroid);
      F.moment = {T(0), T(0), T(0)};
      tau += transpose(J_k) * F;
    };
    std::apply(
        [&](const auto&... J_k) SKINCTL_INLINE_LAMBDA {
          std::size_t k = 0;
          (one(J_k, k++), ...);
        },
        J);
    return tau;
  }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE Memory advance(const Memory& m, const K&, const T& dt,
                                              Opposition) const noexcept {
    const T to = wanted(m), off = to - m.force, step = s_.max_rate * dt;
    const T down = m.hold > T(0) && m.goal >= T(0) ? T(s_.lowering * dt) : step;
    return {off > step ? m.force + step : off < -down ? m.force - down : to, m.goal, m.hold};
  }
  /// Whether the force is the goal's, and the fingertips are at rest against each other, to `still` [m/s].
  template <class K>
  [[nodiscard]] bool settled(const Memory& m, const K& known, const T& still) const noexcept {
    const T rate = shape(known).rate;
    return m.force == wanted(m) && rate <= still && -rate <= still;
  }

  [[nodiscard]] static constexpr std::array<T, fingers> all_alike() noexcept {
    std::array<T, fingers> w{};
    w.fill(T(1));
    return w;
  }

 private:
  [[nodiscard]] static SKINCTL_INLINE T wanted(const Memory& m) noexcept {
    return m.goal >= T(0) && m.hold > m.goal ? m.hold : m.goal;
  }
  template <std::size_t L>
  static constexpr std::size_t place() noexcept {
    constexpr std::size_t links[] = {Ix...};
    std::size_t k = 0;
    while (links[k] != L) ++k;
    return k;
  }
  template <std::size_t L>
  [[nodiscard]] SKINCTL_INLINE Transform<Link<L>, Tool, T> tip() const noexcept {
    const Xyz<T>& p = X_LP_[place<L>()];
    return Transform<Link<L>, Tool, T>::translation_xyz(p.x, p.y, p.z);
  }
  [[nodiscard]] SKINCTL_INLINE auto tips() const noexcept { return std::tuple{tip<Ix>()...}; }
  template <class K>
  [[nodiscard]] SKINCTL_INLINE auto jacobians(const K& known, const auto& X_LP) const noexcept {
    return std::tuple{known.template jacobian<Ix>(std::get<place<Ix>()>(X_LP))...};
  }
  template <class K, class Jacobians>
  [[nodiscard]] SKINCTL_INLINE Shape shape_of(const K& known, const Jacobians& J) const noexcept {
    Shape s;
    Xyz<T> v[fingers], mean{T(0), T(0), T(0)};
    std::size_t k = 0;
    const auto one = [&](const auto& X_BP, const auto& J_k) SKINCTL_INLINE_LAMBDA {
      s.p[k] = X_BP.origin();
      v[k] = (J_k * known.dq()).linear;
      s.centroid = s.centroid + share_[k] * s.p[k];
      mean = mean + share_[k] * v[k];
      ++k;
    };
    (one(known.template pose<Ix>() * tip<Ix>(), std::get<place<Ix>()>(J)), ...);
    for (k = 0; k < fingers; ++k) {
      const Xyz<T> away = s.p[k] - s.centroid;
      const T far = norm(away);
      s.size = s.size + share_[k] * far;
      if (far > T(1e-9)) s.rate = s.rate + share_[k] * dot(away, Xyz<T>(v[k] - mean)) / far;
    }
    return s;
  }

  std::array<Xyz<T>, fingers> X_LP_;
  std::array<T, fingers> weight_, share_{};
  Settings s_;
};

SKINCTL_END_NAMESPACE

// SPDX-License-Identifier: BSD-3-Clause
// The concept of a robot model, and its two implementations: all numbers known at compile time, or at run
// time.
#pragma once

#include <concepts>
#include <utility>

#include "skinctl/core/triple.hpp"
#include "skinctl/model/link.hpp"
#include "skinctl/model/topology.hpp"

SKINCTL_BEGIN_NAMESPACE

namespace detail {
template <class M>
struct ScalarOf {
  using type = double;
};
/// A model with numbers at run time.
template <class M>
concept ModelInScalar = requires { typename M::scalar; };
template <ModelInScalar M>
struct ScalarOf<M> {
  using type = typename M::scalar;
};
/// A tree that knows a number of link `Ix` from its structure.
template <class Tree, std::size_t Ix, LinkParameter P>
concept KnowsNumber = requires { Tree::template known<Ix, P>(); };
}  // namespace detail

/// A robot: a `Topology` whose `number<Ix, P, T>()` gives parameter `P` of link `Ix` as a typed constant
/// (`TypedConstant<0>`) or as a `T`, and whose `gravity<T>()` is the gravitational acceleration in the axes
/// of the base [m/s^2]. Algorithms are written once against this concept; typed constants vanish from the
/// compiled code.
template <class M>
concept RobotModel = Topology<M> && requires(const M& m) {
  m.template number<0, LinkParameter::mass, typename detail::ScalarOf<M>::type>();
  m.template gravity<typename detail::ScalarOf<M>::type>();
};

/// Whether a model computes in `T`: a static one in every scalar, one with numbers at run time in its own.
template <class M, class T>
inline constexpr bool computes_in = true;
template <detail::ModelInScalar M, class T>
inline constexpr bool computes_in<M, T> = std::is_same_v<typename M::scalar, T>;

namespace detail {
/// A model that says that its base moves: see `OnMovingBase`.
template <class M>
concept SaysMovingBase = requires { M::on_moving_base; };
/// A model, and a description, that say whether their masses are assumed.
template <class M>
concept SaysMassesAssumed = requires(const M& model) { model.masses_assumed(); };
template <class D>
concept DescribesLimits = requires {
  D::lower[0] < D::upper[0];
  D::max_velocity;
  D::max_torque;
};
template <class D>
concept DescribesMassesAssumed = requires { D::masses_assumed; };
}  // namespace detail

/// Whether a model says that masses of its links are assumed, as a file without `<inertial>` leaves them.
/// Robots by torque and impedance, and touch from the motors, refuse it.
template <RobotModel M>
[[nodiscard]] constexpr bool has_assumed_masses(const M& model) noexcept {
  if constexpr (detail::SaysMassesAssumed<M>) return model.masses_assumed();
  return false;
}
/// Throws `ConfigurationError` for a model with assumed masses, with the name of `what` needs real ones.
template <RobotModel M>
SKINCTL_COLD void require_masses(const M& model, const char* what) {
  if (has_assumed_masses(model))
    refuse(std::string("skinctl: ") + what +
           " needs the robot's masses, and those of this model are assumed: its "
           "file has no <inertial> for some links; take the maker's, or fit them "
           "(calibration/inertial_fit.hpp)");
}

/// All numbers of link `Ix` of a model that computes in `T`, typed constants included.
template <std::size_t Ix, Scalar T, RobotModel M>
[[nodiscard]] constexpr LinkParameters<double> numbers_of(const M& model) noexcept {
  LinkParameters<double> l;
  [&]<std::size_t... K>(std::index_sequence<K...>) {
    ((l.numbers[K] = static_cast<double>(T(model.template number<Ix, LinkParameter(K), T>()))), ...);
  }(std::make_index_sequence<std::size_t(LinkParameter::count)>{});
  return l;
}

/// A static model has no numbers at run time: it is an empty type made from a description with `constexpr`
/// members `joints`, `parents`, `kinds`, `links` (an array of `LinkParameters<double>`) and `gravity` (three
/// doubles).
template <class Description>
struct StaticModel {
  static_assert(is_tree<Description>(), "parents come before children; 1 to 64 joints");
  static constexpr std::size_t joints = Description::joints;
  static constexpr auto parents = Description::parents;
  static constexpr auto kinds = Description::kinds;

  static constexpr bool masses_assumed() noexcept {
    if constexpr (detail::DescribesMassesAssumed<Description>) return Description::masses_assumed;
    return false;
  }
  template <std::size_t Ix, LinkParameter P, Scalar T>
  static SKINCTL_INLINE constexpr auto number() noexcept {
    constexpr double x = Description::links[Ix][P];
    if constexpr (x == 0.0) {
      return TypedConstant<0>{};
    } else if constexpr (x == 1.0) {
      return TypedConstant<1>{};
    } else if constexpr (x == -1.0) {
      return TypedConstant<-1>{};
    } else {
      return T(x);
    }
  }
  template <Scalar T>
  static SKINCTL_INLINE constexpr auto gravity() noexcept {
    return Triple{gravity_along<0, T>(), gravity_along<1, T>(), gravity_along<2, T>()};
  }

 private:
  template <std::size_t A, Scalar T>
  static SKINCTL_INLINE constexpr auto gravity_along() noexcept {
    constexpr double g = Description::gravity[A];
    if constexpr (g == 0.0) {
      return TypedConstant<0>{};
    } else {
      return T(g);
    }
  }
};

/// A model whose numbers are known at run time: from a file, a calibration, an identification. Only its
/// topology is typed, and that the first child of a link has gamma = 0.
template <Topology Tree, Scalar T = double>
class CalibratedModel {
 public:
  static_assert(is_tree<Tree>(), "parents come before children; 1 to 64 joints");
  using scalar = T;
  static constexpr std::size_t joints = Tree::joints;
  static constexpr auto parents = Tree::parents;
  static constexpr auto kinds = Tree::kinds;
  using Links = std::array<LinkParameters<T>, joints>;

  /// @param links    one per joint, in the order of the tree; checked by `check_link`. The first child of a
  ///                 link must have gamma = 0 (else rotate the parent's frame). Throws `ConfigurationError`.
  /// @param gravity  gravitational acceleration in the axes of the base [m/s^2]; it differs for a base on a
  ///                 wall or ceiling.
  /// @param allowed_defect  limit of `check_link` for the inertias: `makers_density` for a maker's file.
  explicit CalibratedModel(const Links& links, const Xyz<T>& gravity = {T(0), T(0), T(-9.81)},
                           double allowed_defect = rounded_density)
      : links_(links), gravity_(gravity) {
    if constexpr (Real<T>) {
      for (const auto& link : links_) check_link(link, allowed_defect);
      [&]<std::size_t... Ix>(std::index_sequence<Ix...>) {
        (check_promises<Ix>(std::make_index_sequence<std::size_t(LinkParameter::count)>{}), ...);
      }(std::make_index_sequence<joints>{});
    } else {
      static_cast<void>(allowed_defect);
    }
  }

  template <std::size_t Ix, LinkParameter P, Scalar U>
  SKINCTL_INLINE constexpr auto number() const noexcept {
    static_assert(std::is_same_v<U, T>, "a calibrated model computes in the scalar that it stores");
    using Promise = decltype(promised<Ix, P>());
    if constexpr (is_known<Promise>) {
      return Promise{};
    } else {
      return T(links_[Ix][P]);
    }
  }
  template <Scalar U>
  SKINCTL_INLINE constexpr Xyz<T> gravity() const noexcept {
    static_assert(std::is_same_v<U, T>, "a calibrated model computes in the scalar that it stores");
    return gravity_;
  }
  /// The numbers of link `i`.
  const LinkParameters<T>& link(std::size_t i) const noexcept { return links_[i]; }
  /// Marks the masses as assumed: see `has_assumed_masses`.
  void assume_masses() noexcept { assumed_ = true; }
  [[nodiscard]] constexpr bool masses_assumed() const noexcept { return assumed_; }

 private:
  template <std::size_t Ix, LinkParameter P>
  static constexpr auto promised() noexcept {
    if constexpr (P == LinkParameter::sin_gamma && is_first_child(Ix)) {
      return TypedConstant<0>{};
    } else if constexpr (P == LinkParameter::cos_gamma && is_first_child(Ix)) {
      return TypedConstant<1>{};
    } else if constexpr (detail::KnowsNumber<Tree, Ix, P>) {
      return Tree::template known<Ix, P>();
    } else {
      return;
    }
  }
  template <std::size_t Ix, std::size_t... P>
  void check_promises(std::index_sequence<P...>) const {
    const auto check = [&]<std::size_t K>(std::integral_constant<std::size_t, K>) {
      using Promise = decltype(promised<Ix, LinkParameter(K)>());
      if constexpr (is_known<Promise>)
        require(links_[Ix][LinkParameter(K)] == T(Promise::value),
                "link parameter that the tree's type fixes",
                static_cast<double>(links_[Ix][LinkParameter(K)]),
                "the promised constant (first children: gamma = 0)");
    };
    (check(std::integral_constant<std::size_t, P>{}), ...);
  }
  static constexpr bool is_first_child(std::size_t i) noexcept {
    if (parents[i] < 0) return false;
    for (std::size_t j = 0; j < i; ++j)
      if (parents[j] == parents[i]) return false;
    return true;
  }
  Links links_;
  Xyz<T> gravity_;
  bool assumed_ = false;
};

/// A calibrated model of a static description: same tree, same numbers, as a starting point for a
/// calibration; a maker's inertias are accepted as published (`makers_density`).
template <class Description, Scalar T = double>
CalibratedModel<Description, T> calibrated_from() {
  typename CalibratedModel<Description, T>::Links links;
  for (std::size_t i = 0; i < Description::joints; ++i) links[i] = Description::links[i].template cast<T>();
  CalibratedModel<Description, T> model(
      links, {T(Description::gravity[0]), T(Description::gravity[1]), T(Description::gravity[2])},
      makers_density);
  if constexpr (StaticModel<Description>::masses_assumed()) model.assume_masses();
  return model;
}

SKINCTL_END_NAMESPACE

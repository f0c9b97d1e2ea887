// SPDX-License-Identifier: BSD-3-Clause
// A robot with a load: a tool, a payload.
#pragma once

#include "skinctl/model/placement.hpp"

SKINCTL_BEGIN_NAMESPACE

/// `M` with a load fixed to link `L`, which may change at run time: a tool is exchanged, a part is gripped.
/// Only the inertia of link `L` becomes run-time numbers; typed constants of the other links stay typed, so
/// the load costs no more than its own link.
template <RobotModel M, std::size_t L, Scalar T = double>
class Loaded : public M {
 public:
  static_assert(L < M::joints, "the model has no such link");
  using scalar = T;

  /// Carries `load` (in the frame of link L; see `seen_from`), nothing by default.
  explicit Loaded(const M& model, const LinkInertia& load = {}) : M(model) { carry(load); }

  /// Fixes `load` and nothing else to link L from now on: `{}` is no load. For use between cycles; no
  /// allocation. Throws `ConfigurationError` for a physically impossible load, and then changes nothing.
  void carry(const LinkInertia& load) {
    check_link(make_link({}, load));
    const LinkParameters<double> sum =
        make_link({}, combined(inertia_of(numbers_of<L, T>(static_cast<const M&>(*this))), load));
    link_ = sum.template cast<T>();
  }

  template <std::size_t Ix, LinkParameter P, Scalar U>
  SKINCTL_INLINE constexpr auto number() const noexcept {
    if constexpr (Ix == L && P >= LinkParameter::mass) {
      static_assert(std::same_as<U, T>, "a loaded model computes in the scalar that it stores");
      return T(link_[P]);
    } else {
      return M::template number<Ix, P, U>();
    }
  }

 private:
  LinkParameters<T> link_;
};

SKINCTL_END_NAMESPACE

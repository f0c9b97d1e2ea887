// A robot that carries something: a tool, a payload.
#pragma once

#include "skinctl/model/placement.hpp"

SKINCTL_BEGIN_NAMESPACE

/// `M` with a load fixed to link `L`, which may change at run time: a tool that is exchanged, a part that is
/// gripped. Only the inertia of link `L` becomes numbers at run time; whatever the type of `M` knows of the
/// others, it goes on knowing, so the load costs no more than its own link.
template <Model M, std::size_t L, Scalar T = double>
class Loaded : public M {
 public:
  static_assert(L < M::joints, "the model has no such link");
  using scalar = T;

  /// Carries `load` (in the frame of link L; see `seen_from`), nothing by default.
  explicit Loaded(const M& model, const LinkInertia& load = {}) : M(model) { carry(load); }

  /// From now on link L carries `load` and nothing else: `{}` puts everything down. For use between cycles;
  /// no allocation. Throws `ConfigurationError` for a load that cannot exist, and changes nothing then.
  void carry(const LinkInertia& load) {
    check_link(make_link({}, load));
    const LinkParameters<double> sum = make_link({}, combined(empty(), load));
    link_ = sum.template cast<T>();
  }

  template <std::size_t I, Parameter P, Scalar U>
  SKINCTL_INLINE constexpr auto number() const noexcept {
    if constexpr (I == L && P >= Parameter::mass) {
      static_assert(std::same_as<U, T>, "a loaded model computes in the scalar that it stores");
      return T(link_[P]);
    } else {
      return M::template number<I, P, U>();
    }
  }

 private:
  /// The link of the model itself.
  LinkInertia empty() const {
    using P = Parameter;
    const auto own = [this]<P p>(std::integral_constant<P, p>) {
      return static_cast<double>(T(M::template number<L, p, T>()));
    };
    const auto at = [&]<P p>() { return own(std::integral_constant<P, p>{}); };
    const double xx = at.template operator()<P::s_xx>(), yy = at.template operator()<P::s_yy>(),
                 zz = at.template operator()<P::s_zz>();
    return {
      at.template operator()<P::mass>(),
      {at.template operator()<P::c_x>(), at.template operator()<P::c_y>(), at.template operator()<P::c_z>()},
      yy + zz,
      xx + zz,
      xx + yy,
      -at.template operator()<P::s_xy>(),
      -at.template operator()<P::s_xz>(),
      -at.template operator()<P::s_yz>()
    };
  }
  LinkParameters<T> link_;
};

SKINCTL_END_NAMESPACE

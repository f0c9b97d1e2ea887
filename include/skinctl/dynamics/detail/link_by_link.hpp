// The recursions of a chain or tree as loops over a table of its links: one copy of their code for all links.
#pragma once

#include "skinctl/dynamics/detail/recursion.hpp"
#include "skinctl/model/link_by_link.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The constant that parameter `P` is in every link of `M`; nothing if it differs, or is no typed constant.
template <RobotModel M, LinkParameter P, Scalar T>
constexpr auto common_number() noexcept {
  return []<std::size_t... I>(std::index_sequence<I...>) {
    using First = decltype(std::declval<const M&>().template number<0, P, T>());
    if constexpr (is_known<First>) {
      if constexpr ((std::is_same_v<First, decltype(std::declval<const M&>().template number<I, P, T>())> &&
                     ...))
        return First{};
    }
  }(std::make_index_sequence<M::joints>{});
}
template <RobotModel M, LinkParameter P, Scalar T>
inline constexpr bool is_common = !std::is_void_v<decltype(common_number<M, P, T>())>;

/// The parameters that differ from link to link have a column each in the table of links.
template <RobotModel M, Scalar T>
struct LinkColumns {
  static constexpr std::size_t parameters = std::size_t(LinkParameter::count);
  template <std::size_t... P>
  static constexpr std::size_t before(std::size_t p, std::index_sequence<P...>) noexcept {
    return ((P < p && !is_common<M, LinkParameter(P), T> ? 1u : 0u) + ... + 0u);
  }
  static constexpr std::size_t of(LinkParameter p) noexcept {
    return before(std::size_t(p), std::make_index_sequence<parameters>{});
  }
  static constexpr std::size_t count = before(parameters, std::make_index_sequence<parameters>{});
};

/// Link number `i` of `M`, known at run time, as the only link of a model: algorithms that are written for link `I` of a
/// model serve it. What is the same constant in all links stays typed.
template <RobotModel M, Scalar T>
struct LinkInTurn {
  static constexpr std::size_t joints = 1;
  static constexpr auto parents = chain_parents<1>();
  static constexpr auto kinds = all_of_kind<1>(JointKind::revolute);
  using Columns = LinkColumns<M, T>;
  using Table = std::array<std::array<T, Columns::count>, M::joints>;

  template <std::size_t, LinkParameter P, Scalar U>
  SKINCTL_INLINE constexpr auto number() const noexcept {
    if constexpr (is_common<M, P, T>) {
      return common_number<M, P, T>();
    } else {
      return row[Columns::of(P)];
    }
  }
  template <Scalar U>
  SKINCTL_INLINE constexpr auto gravity() const noexcept {
    return M::template gravity<U>();
  }
  SKINCTL_INLINE constexpr auto frame(const T& sin, const T& cos) const noexcept {
    using P = LinkParameter;
    return JointFrame{Turn{number<0, P::cos_gamma, T>(), number<0, P::sin_gamma, T>()},
                      Turn{number<0, P::cos_alpha, T>(), number<0, P::sin_alpha, T>()}, Turn{cos, sin},
                      Triple{number<0, P::p_x, T>(), number<0, P::p_y, T>(), number<0, P::p_z, T>()}};
  }

  static constexpr Table made() noexcept {
    Table table{};
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      const auto fill = [&]<std::size_t K, std::size_t... P>(std::integral_constant<std::size_t, K>,
                                                             std::index_sequence<P...>) {
        const auto one = [&]<std::size_t Q>(std::integral_constant<std::size_t, Q>) {
          if constexpr (!is_common<M, LinkParameter(Q), T>)
            table[K][Columns::of(LinkParameter(Q))] = T(M::template number<K, LinkParameter(Q), T>());
        };
        (one(std::integral_constant<std::size_t, P>{}), ...);
      };
      (fill(std::integral_constant<std::size_t, I>{},
            std::make_index_sequence<std::size_t(LinkParameter::count)>{}),
       ...);
    }(std::make_index_sequence<M::joints>{});
    return table;
  }
  static constexpr Table table = made();
  const T* row;
};
template <RobotModel M, Scalar T>
SKINCTL_INLINE LinkInTurn<M, T> link_in_turn(std::size_t i) noexcept {
  return {LinkInTurn<M, T>::table[i].data()};
}

/// `run_recursion` link by link; joints as arrays, `a0` dense.
template <RobotModel M, Scalar T>
SKINCTL_NOINLINE void recursion_in_loop(const T* sin, const T* cos, const T* dq, const T* dq_r,
                                        const T* ddq_r, const Xyz<T>& a0, T* tau) noexcept {
  constexpr UnitZ z{};
  const Xyz<T> zero{T(0), T(0), T(0)};
  Xyz<T> f[M::joints], n[M::joints];
  Xyz<T> w = zero, w_r = zero, alpha = zero, a = a0;
  Spin<Xyz<T>, Xyz<T>, Xyz<T>> spin{zero, zero, zero};
  SKINCTL_ROLLED
  for (std::size_t i = 0; i < M::joints; ++i) {
    const auto link = link_in_turn<M, T>(i);
    const auto frame = link.frame(sin[i], cos[i]);
    assign(a, frame.to_link(a + spin * frame.p));
    const auto w_in = frame.to_link(w);
    assign(alpha, frame.to_link(alpha) + ddq_r[i] * z + dq_r[i] * cross(w_in, z));
    assign(w_r, frame.to_link(w_r) + dq_r[i] * z);
    assign(w, w_in + dq[i] * z);
    const auto made = make_spin(w, w_r, alpha);
    assign(spin.x, made.x), assign(spin.y, made.y), assign(spin.z, made.z);
    const auto own = inertial_wrench<0, T>(link, spin, a);
    assign(f[i], own.f), assign(n[i], own.n);
  }
  SKINCTL_ROLLED
  for (std::size_t i = M::joints - 1; i > 0; --i) {
    tau[i] = n[i].z;
    const auto frame = link_in_turn<M, T>(i).frame(sin[i], cos[i]);
    const auto force = frame.to_parent(f[i]);
    assign(n[i - 1], n[i - 1] + (frame.to_parent(n[i]) + cross(frame.p, force)));
    assign(f[i - 1], f[i - 1] + force);
  }
  tau[0] = n[0].z;
}

}  // namespace detail
SKINCTL_END_NAMESPACE

// The memory of a resolver for groups of joints.
#pragma once

#include "skinctl/resolver/memory.hpp"
#include "skinctl/robot/joint_groups.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The element `K` of a tuple that is trivially copyable.
template <std::size_t K, class Value>
struct Element {
  Value value;
};
template <class Indices, class... Values>
struct PlainTuple;
template <std::size_t... K, class... Values>
struct PlainTuple<std::index_sequence<K...>, Values...> : Element<K, Values>... {};

template <std::size_t K, class Value>
[[nodiscard]] SKINCTL_INLINE Value& element(Element<K, Value>& e) noexcept {
  return e.value;
}
template <std::size_t K, class Value>
[[nodiscard]] SKINCTL_INLINE const Value& element(const Element<K, Value>& e) noexcept {
  return e.value;
}

/// The virtual joints of each group, in a plain tuple.
template <Real T, std::size_t History, class Groups>
struct VirtualGroups;
template <Real T, std::size_t History, class... Groups>
struct VirtualGroups<T, History, std::tuple<Groups...>> {
  using Memory = PlainTuple<std::make_index_sequence<sizeof...(Groups)>,
                            VirtualJointsMemory<Groups::count, T, History>...>;
};

/// What joints by torque remember beside their measurement.
template <std::size_t N, Real T, bool HasTank>
struct DrivenMemory {
  struct NoTank {};
  OwnTorque<N, T> own;  ///< of the laws in the last cycle
  JointTorque<N, T> torque;
  [[no_unique_address]] std::conditional_t<HasTank, typename EnergyTank<T>::template Held<N>, NoTank> tank;
};
template <Real T, bool HasTank>
struct DrivenMemory<0, T, HasTank> {};

}  // namespace detail

/// Memory of a resolver for groups of joints. Trivially copyable.
template <class M, Real T, class Sets, std::size_t History, class Keeper>
struct GroupMemory {
  static constexpr std::size_t joints = M::joints;
  using Groups = typename Sets::StiffGroups;
  bool started = false;
  bool stop = false;  ///< a stop was requested
  typename detail::VirtualGroups<T, History, Groups>::Memory stiff;
  [[no_unique_address]] detail::DrivenMemory<Sets::Driven::count, T, Keeper::template has<EnergyTank<T>>>
      driven;
  detail::OwnTorque<Sets::Stiff::count, T> own;  ///< of the laws in the last sub-step
  State<joints, T> measured;                     ///< the last good measurement, of all joints
  JointCommand<joints, T> command;               ///< the last one
  [[no_unique_address]] typename Keeper::template Memory<joints> keeper;

  /// The virtual joints of the stiff group `K`.
  template <std::size_t K = 0>
  [[nodiscard]] SKINCTL_INLINE auto& group() noexcept {
    return detail::element<K>(stiff);
  }
  template <std::size_t K = 0>
  [[nodiscard]] SKINCTL_INLINE const auto& group() const noexcept {
    return detail::element<K>(stiff);
  }
};

SKINCTL_END_NAMESPACE

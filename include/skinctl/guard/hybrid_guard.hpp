// The guard of a robot whose joints are of two kinds: one guard for each.
#pragma once

#include "skinctl/guard/guard.hpp"
#include "skinctl/resolver/hybrid_resolver.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The memory of a hybrid guard. Trivially copyable.
template <std::size_t Stiff, std::size_t Driven, Real T>
struct HybridGuardMemory {
  GuardMemory<Stiff, T> stiff;
  GuardMemory<Driven, T> driven;
};

/// A `Guard` for the joints of a hybrid resolver that take positions or velocities, and one for those that
/// take torques. Each reacts to faults of its own joints and to those that other stages found; a fault of one
/// that waits for consent stops both, by the resolver, until `acknowledge`.
///
/// `HybridGuard(resolver, stiff, driven)`: limits and periods are the resolver's, the settings one's own.
/// Throws `ConfigurationError` as `Guard`.
template <class Hybrid>
class HybridGuard {
 public:
  static constexpr std::size_t joints = Hybrid::joints;
  using Stiff = typename Hybrid::Stiff;
  using Driven = typename Hybrid::Driven;
  using T = typename Hybrid::scalar;
  using Memory = HybridGuardMemory<Stiff::count, Driven::count, T>;

  explicit HybridGuard(const Hybrid& resolver, const GuardSettings<Stiff::count, T>& stiff = {},
                       const GuardSettings<Driven::count, T>& driven = {})
      : stiff_({.limits = resolver.stiff_limits(),
                .period = resolver.parameters().period,
                .longest_interval = resolver.parameters().longest_interval},
               stiff),
        driven_({.limits = resolver.torque_limits(),
                 .period = resolver.parameters().period,
                 .longest_interval = resolver.parameters().longest_interval},
                driven) {}

  /// As `Guard::start`, for both.
  [[nodiscard]] SKINCTL_COLD Memory start(const JointCommand<joints, T>& command,
                                          const State<joints, T>& measured) const noexcept {
    return {stiff_.start(part<Stiff>(command), part<Stiff>(measured)),
            driven_.start(part<Driven>(command), part<Driven>(measured))};
  }

  /// The command that may leave at `now`, as `Guard::step`.
  Guarded<joints, T> step(Memory& m, const JointCommand<joints, T>& wish, const State<joints, T>& measured,
                          Nanoseconds now, const JointTorque<joints, T>& fallback = {},
                          Status found = {}) const noexcept {
    const auto a = stiff_.step(m.stiff, part<Stiff>(wish), part<Stiff>(measured), now, {}, found);
    const auto b =
        driven_.step(m.driven, part<Driven>(wish), part<Driven>(measured), now, Driven::of(fallback), found);
    Guarded<joints, T> out{wish, a.status | b.status, a.altered || b.altered};
    out.command.time = a.command.time;
    out.command.valid = a.command.valid && b.command.valid;
    put<Stiff>(a.command, out.command);
    put<Driven>(b.command, out.command);
    return out;
  }

  /// The user's consent, to both.
  void acknowledge(Memory& m) const noexcept {
    stiff_.acknowledge(m.stiff);
    driven_.acknowledge(m.driven);
  }
  [[nodiscard]] static bool waits(const Memory& m) noexcept {
    return Guard<Hybrid::stiff_interface, Stiff::count, T>::waits(m.stiff) ||
           Guard<Interface::torque, Driven::count, T>::waits(m.driven);
  }
  /// Whether this robot can be in the state `s`.
  [[nodiscard]] bool believes(const State<joints, T>& s) const noexcept {
    return stiff_.believes(part<Stiff>(s)) && driven_.believes(part<Driven>(s));
  }

 private:
  template <class Subset, class Whole>
  static SKINCTL_INLINE auto part(const Whole& whole) noexcept {
    return Hybrid::template part_of<Subset>(whole);
  }
  template <class Subset>
  static SKINCTL_INLINE void put(const JointCommand<Subset::count, T>& from,
                                 JointCommand<joints, T>& to) noexcept {
    Subset::put(from.position, to.position);
    Subset::put(from.velocity, to.velocity);
    Subset::put(from.acceleration, to.acceleration);
    Subset::put(from.torque, to.torque);
  }

  Guard<Hybrid::stiff_interface, Stiff::count, T> stiff_;
  Guard<Interface::torque, Driven::count, T> driven_;
};

SKINCTL_END_NAMESPACE

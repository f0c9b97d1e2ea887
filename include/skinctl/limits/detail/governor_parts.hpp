// The limits of a governor that concern the whole robot, and what they leave of its velocity.
#pragma once

#include "skinctl/core/command.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/core/status.hpp"
#include "skinctl/limits/detail/parts.hpp"
#include "skinctl/robot/joint_limits.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// The velocity that limits leave, and why.
template <std::size_t N, Real T>
struct Slowed {
  JointVelocity<N, T> velocity;
  Status status;
  bool slowed = false;

  SKINCTL_INLINE void by(const T& share) noexcept {
    if (share < T(1)) slowed = true, velocity = share * velocity;
  }
};

/// What governors of one and of several interfaces share: each part is `NoPart` where the scene has none.
template <std::size_t N, Real T, class Jerk, class Tool, class Contact, class Range, class Watch, class Clear>
class GovernorParts {
 public:
  static constexpr std::size_t joints = N;
  using scalar = T;
  using contact_type = Contact;
  static constexpr bool has_jerk = !std::is_same_v<Jerk, NoPart>;
  static constexpr bool has_tool = !std::is_same_v<Tool, NoPart>;
  static constexpr bool has_contact = !std::is_same_v<Contact, NoPart>;
  static constexpr bool has_motion = !std::is_same_v<Range, NoPart>;
  static constexpr bool has_watch = !std::is_same_v<Watch, NoPart>;
  static constexpr bool has_clearance = !std::is_same_v<Clear, NoPart>;
  static constexpr bool has_surroundings = requires { requires Clear::around > 0; };
  /// The number of cycles of the prediction of torques, and of braking by them.
  static constexpr int braking_cycles = 4;

  struct Memory {
    [[no_unique_address]] typename Contact::Memory contact;
    [[no_unique_address]] typename Watch::Memory watch;
    [[no_unique_address]] typename Range::Memory motion;
    [[no_unique_address]] typename Clear::Memory around;
  };

  SKINCTL_COLD GovernorParts(const JointLimits<N, T>& limits, const Jerk& jerk, const Tool& tool,
                             const Contact& contact, const Range& motion, const Watch& watch,
                             const Clear& clearance)
      : limits_(limits),
        jerk_(jerk),
        tool_(tool),
        contact_(contact),
        motion_(motion),
        watch_(watch),
        clearance_(clearance) {}

  [[nodiscard]] const JointLimits<N, T>& limits() const noexcept { return limits_; }
  [[nodiscard]] const Jerk& jerk() const noexcept { return jerk_; }
  [[nodiscard]] const Tool& tool() const noexcept { return tool_; }
  [[nodiscard]] const Contact& contact() const noexcept { return contact_; }
  [[nodiscard]] const Range& motion() const noexcept { return motion_; }
  [[nodiscard]] const Watch& watch() const noexcept { return watch_; }
  [[nodiscard]] const Clear& clearance() const noexcept { return clearance_; }

 protected:
  /// What contacts, and too few cells that report, leave of `u`.
  template <class Touch, class Nearest>
  [[nodiscard]] SKINCTL_INLINE Slowed<N, T> felt(Memory& m, const State<N, T>& measured,
                                                 const JointVelocity<N, T>& u, const Touch& touch,
                                                 const Nearest& nearest, const T& dt) const noexcept {
    Slowed<N, T> out{u, {}};
    if constexpr (has_contact) {
      const auto verdict = contact_.look(m.contact, measured, u, touch, contact_.distances(nearest), dt);
      out.status |= verdict.status;
      out.by(verdict.scale);
    }
    if constexpr (has_watch) out.by(watch_.share(m.watch, out.velocity));
    return out;
  }
  /// Slows `s` to the tool's speed, from `q` and the velocity `from` on, `dt` seconds ahead.
  SKINCTL_INLINE void keep_tool_speed(const JointPosition<N, T>& q, const JointRoom<N, T>& room,
                                      const JointVelocity<N, T>& from, const T& dt,
                                      Slowed<N, T>& s) const noexcept {
    if constexpr (has_tool) {
      const auto kept = tool_.within(q, room, from, reached(room, from, dt, s), dt);
      s.velocity = kept.velocity;
      if (kept.limited) s.status |= Reason::tool_speed_limited, s.slowed = true;
    }
  }
  /// The same for clearances; where these turn a motion that `slides` aside, the tool keeps its speed.
  SKINCTL_INLINE void keep_clear(const Memory& m, const JointPosition<N, T>& q, const JointRoom<N, T>& room,
                                 const JointVelocity<N, T>& from, const T& dt, Slowed<N, T>& s,
                                 bool slides) const noexcept {
    if constexpr (has_clearance) {
      const auto tool_keeps = [&](const JointVelocity<N, T>& v) {
        if constexpr (has_tool) {
          return tool_.keeps(q, v, half_way(from, v, dt), room);
        } else {
          return true;
        }
      };
      const auto kept =
          clearance_.within(m.around, q, room, from, reached(room, from, dt, s), dt, tool_keeps, slides);
      s.velocity = kept.velocity;
      if (kept.limited) s.status |= Reason::clearance_kept, s.slowed = true;
    }
  }
  /// The limits that a motion breaks which is smooth instead of hard.
  [[nodiscard]] SKINCTL_INLINE Status broken(const Memory& m, const JointPosition<N, T>& q,
                                             const JointRoom<N, T>& room, const JointVelocity<N, T>& velocity,
                                             const JointPosition<N, T>& displacement) const noexcept {
    Status out;
    if constexpr (has_tool)
      if (!tool_.keeps(q, velocity, displacement, room)) out |= Reason::tool_speed_limited;
    if constexpr (has_clearance)
      if (!clearance_.keeps(m.around, q, velocity, displacement, room)) out |= Reason::clearance_kept;
    return out;
  }
  /// The displacement from the velocity `from` to `to` in `dt`.
  [[nodiscard]] static SKINCTL_INLINE JointPosition<N, T> half_way(const JointVelocity<N, T>& from,
                                                                   const JointVelocity<N, T>& to,
                                                                   const T& dt) noexcept {
    return integrate(JointPosition<N, T>(), from + to, T(T(0.5) * dt));
  }

  JointLimits<N, T> limits_;
  [[no_unique_address]] Jerk jerk_;
  [[no_unique_address]] Tool tool_;
  [[no_unique_address]] Contact contact_;
  [[no_unique_address]] Range motion_;
  [[no_unique_address]] Watch watch_;
  [[no_unique_address]] Clear clearance_;

 private:
  /// The velocity in `dt`: what was asked for was within the limits of the joints, what is slowed may not be.
  [[nodiscard]] SKINCTL_INLINE JointVelocity<N, T> reached(const JointRoom<N, T>& room,
                                                           const JointVelocity<N, T>& from, const T& dt,
                                                           const Slowed<N, T>& s) const noexcept {
    return s.slowed ? limits_.move(room, from, s.velocity, dt).velocity : s.velocity;
  }
};

}  // namespace detail
SKINCTL_END_NAMESPACE

// Damping of contacts that ring.
#pragma once

#include <cmath>

#include "skinctl/core/joint.hpp"
#include "skinctl/robot/robot_description.hpp"
#include "skinctl/tactile/contact.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Friction along contacts: a joint torque `-coefficient[k] row[k] (row[k] . dq)` each, coefficients in
/// [N m s] or [N s/m]. Symmetric and not negative: it only dissipates.
template <std::size_t N, Real T = double>
struct ContactDamping {
  std::size_t count = 0;
  T coefficient[max_contacts<N>] = {};
  T row[max_contacts<N>][N] = {};
  bool any = false;
};

/// Contact damping, constant and by observation. A part of a resolver's `Passivity`.
///
/// Each contact's push is watched for turns: it rose and then fell by more than `swing` and by more than a
/// tenth of the push, or the reverse. A contact rings if turns come within `slowest` of each other and do not
/// die out quickly (each swing at least 0.4 of the last one); so does one that bounces, however long the robot
/// flies, if it returns by itself. The third turn in a row raises the damping along the contact to a sixteenth
/// of `max`, and each further one triples it (`contact_damped`). Turns count in full up to 7/8 of `slowest`,
/// and less and less from there to `slowest`. The damping is at least `always` while the
/// contact lasts, at most `always + max`, rises and falls smoothly, and falls once the contact has ended, with
/// the time constant `calm`. No damping is added for a robot that is not touched, for a push that takes longer
/// than `slowest` from peak to trough, and for taps on a robot that rests or gives way.
template <Real T = double>
class ContactDamper {
 public:
  using RobotPart = detail::PassivityPart;
  struct Settings {
    T max = T(0);     ///< largest added damping of the virtual robot [N s/m], >= 0: see `contact_damping`
    T always = T(0);  ///< during a contact [N s/m], >= 0, for a delay: see `contact_damping`
    T swing = T(2);   ///< smallest change of a push that counts [N], > 0: at least two quanta of the sensor
    Nanoseconds slowest = 250ms;  ///< longest time from peak to trough, > 0
    Nanoseconds calm = 500ms;     ///< > 0
  };
  /// The observation of one contact.
  struct Watch {
    std::size_t link = 0;
    Xyz<T> place = {T(0), T(0), T(0)}, normal = {T(0), T(0), T(0)};  ///< when it was last felt
    T extreme = T(0);                                                ///< extreme push since the last turn [N]
    T last = T(0);                                                   ///< the push at that turn [N]
    T swing = T(0);                                                  ///< of the last turn [N]
    T since = T(0);                                                  ///< time since the last turn [s]
    T away = T(0);                                                   ///< time without contact [s]
    T turns = T(0);                                                  ///< in a row, up to 3
    bool rising = false;
    bool touched = false;
    T wish = T(0);   ///< wanted damping, in parts of `max`
    T level = T(0);  ///< present damping, in parts of `max`
  };
  template <std::size_t N>
  struct Memory {
    Watch watch[max_contacts<N>];
    ContactDamping<N, T> damping;  ///< in the order of `watch`
  };

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD explicit ContactDamper(const Settings& s = {})
      : s_(s), slowest_(seconds<T>(s.slowest)), calm_(seconds<T>(s.calm)) {
    const auto number = [](const T& x) { return static_cast<double>(x); };
    require(s.max >= T(0) && s.max <= T(1e6), "most contact damping", number(s.max), "0 to 1e6 N s/m");
    require(s.always >= T(0) && s.always <= T(1e6), "contact damping", number(s.always), "0 to 1e6 N s/m");
    require(s.swing > T(0) && s.swing <= T(1e6), "least swing", number(s.swing), "> 0, <= 1e6 N");
    require(s.slowest > 0ns && s.slowest <= 10s, "slowest swing", seconds<double>(s.slowest), "> 0, <= 10 s");
    require(s.calm > 0ns && s.calm <= 1000s, "calm", seconds<double>(s.calm), "> 0, <= 1000 s");
  }
  [[nodiscard]] const Settings& settings() const noexcept { return s_; }

  template <std::size_t N>
  [[nodiscard]] Memory<N> start() const noexcept {
    return {};
  }

  /// A cycle of `dt` seconds with these contacts of a robot that moves at `dq`, as measured. True if damping
  /// is added to `always`.
  template <std::size_t N, std::size_t K>
  bool observe(Memory<N>& memory, const Contacts<N, T, K>& contacts, const JointVelocity<N, T>& dq,
               const T& dt) const noexcept {
    static_assert(K <= max_contacts<N>);
    auto& damping = memory.damping;
    T force[max_contacts<N>] = {}, speed[max_contacts<N>] = {};
    bool taken[max_contacts<N>] = {};
    for (const auto& c : contacts) {
      if (!(c.force > T(0))) continue;
      std::size_t k = detail::continued(memory.watch, taken, damping.count, c);
      if (k == damping.count) k = room(memory, taken);
      taken[k] = true;
      force[k] = c.force;
      speed[k] = c.along(dq);
      Watch& w = memory.watch[k];
      w.link = c.link, w.place = c.place, w.normal = c.normal;
      for (std::size_t j = 0; j < N; ++j) damping.row[k][j] = c.row[j];
    }
    bool added = false;
    damping.any = false;
    for (std::size_t k = 0; k < damping.count; ++k) {
      Watch& w = memory.watch[k];
      if (force[k] > T(0) || w.touched) watch(w, force[k], speed[k], dt);
      T& b = damping.coefficient[k];
      b = w.level * s_.max + (force[k] > T(0) ? s_.always : T(0));
      damping.any = damping.any || b > T(0);
      added = added || w.level > T(0);
    }
    while (damping.count > 0 && !memory.watch[damping.count - 1].touched) --damping.count;
    return added;
  }

 private:
  /// Room for a contact that was not there: unused, or that of the ended contact with the least damping.
  template <std::size_t N>
  static std::size_t room(Memory<N>& memory, const bool* taken) noexcept {
    auto& count = memory.damping.count;
    std::size_t best = max_contacts<N>;
    for (std::size_t k = 0; k < count; ++k) {
      if (taken[k]) continue;
      if (!memory.watch[k].touched) return k;
      if (best == max_contacts<N> || memory.watch[k].level < memory.watch[best].level) best = k;
    }
    if (count < max_contacts<N>) best = count++;
    memory.watch[best] = {};
    return best;
  }

  [[nodiscard]] static T part(const T& x) noexcept { return x < T(0) ? T(0) : x < T(1) ? x : T(1); }

  void watch(Watch& w, const T& force, const T& speed, const T& dt) const noexcept {
    using std::exp;
    w.touched = true;
    if (force > T(0)) {
      // A robot that returns by itself has bounced: the flight does not count.
      w.since = w.since + dt + (speed > T(0) ? T(0) : w.away);
      w.away = T(0);
    } else {
      w.away = w.away + dt;
    }
    const T high = w.rising ? w.extreme : w.last;
    const T bound = s_.swing > T(0.1) * high ? s_.swing : T(T(0.1) * high);
    const T back = w.rising ? T(w.extreme - force) : T(force - w.extreme);
    if (back < T(0)) {
      w.extreme = force;
    } else if (back > bound) {
      const T swing = w.rising ? T(w.extreme - w.last) : T(w.last - w.extreme);
      // How much the row of turns goes on with this one: the limit is not hard, or a hair would decide between damping
      // and none, and a finger that drives on feels the whole of it.
      T row(0);
      if (w.swing > T(0) && swing >= T(0.4) * w.swing) row = part(T(8) * (T(1) - w.since / slowest_));
      w.turns = row * w.turns + T(1);
      if (w.turns > T(3)) w.turns = T(3);
      if (w.turns > T(2)) {
        const T wish = w.wish < T(0.03125) ? T(0.0625) : T(3) * w.wish;
        w.wish = w.wish + (w.turns - T(2)) * ((wish < T(1) ? wish : T(1)) - w.wish);
      }
      w.swing = swing;
      w.last = w.extreme;
      w.extreme = force;
      w.rising = !w.rising;
      w.since = T(0);
    }
    if (w.since > slowest_) w.turns = T(0);
    if (!(force > T(0))) w.wish = w.wish * exp(-dt / calm_);  // what has rung would ring again
    const T rise = T(1) - exp(-dt / (T(0.1) * calm_));
    w.level = w.level + rise * (w.wish - w.level);
    if (w.level < T(1e-3) && w.wish < T(1e-3)) w.level = w.wish = T(0);
    if (w.level == T(0) && w.away > T(8) * slowest_) w = {};
  }

  Settings s_;
  T slowest_, calm_;
};

SKINCTL_END_NAMESPACE

// SPDX-License-Identifier: BSD-3-Clause
// The bits between a hand and the objects around it, from which activities are recognised.
#pragma once

#include "skinctl/semantics/bit.hpp"
#include "skinctl/semantics/speed_estimate.hpp"
#include "skinctl/semantics/world.hpp"
#include "skinctl/sensing/low_pass.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A hand, a robot's or a person's: its pose, and the force of its fingers.
template <Frame W = World>
struct HandSample {
  Nanoseconds time{};
  Transform<W, Tool> X_WH{};
  /// Standard deviation of the position along each axis, independent from sample to sample [m].
  double sigma = 0.0002;
  double force = 0;  ///< force of the fingers on the object [N]; NaN: nothing measures it
};

/// The features at an instant. Sections 2.2 and 5 of the paper.
struct Features {
  Nanoseconds time{};
  Nanoseconds event{};  ///< stamp of the newest change of a bit: when it happened, not when it was decided
  bool known = false;   ///< whether the signals suffice; if not, the bits mean nothing
  bool moving = false;
  bool in_hand = false;           ///< something is between the fingers
  bool squeezed = false;          ///< the carried object is pressed harder than it was held
  bool carried = false;           ///< the object has been moved since contact
  bool tool = false;              ///< the object is a tool, and another object is near
  bool left = true;               ///< the hand has gone away from the object that it released last
  std::uint8_t held = no_object;  ///< the object in hand, or the last one that was
  std::uint8_t near = no_object;  ///< the other object nearest to the hand
  ObjectClass held_kind = 0, near_kind = 0;

  // The numbers behind the bits.
  double speed = 0;          ///< speed of the hand [m/s]
  double force = 0;          ///< filtered force of the fingers [N]
  double ratio = 0;          ///< force over holding force while something is in hand; else 0
  double moved = 0;          ///< distance of the hand from where contact began, or ended [m]
  double near_distance = 0;  ///< distance of the hand from `near` [m]; 10 where there is none
  double elapsed = 0;        ///< time since contact began, or ended [s]; at most 10
};

/// Settings of a feature extractor.
struct FeatureSettings {
  SpeedEstimate<>::Settings speed{};
  Bit<>::Settings moving{0.035, 0.025, 10ms, 20ms};  ///< thresholds of the hand's speed [m/s]
  Nanoseconds force_filter = 4ms;                    ///< time constant of the force's low pass
  Bit<>::Settings in_hand{0.5, 0.25, 8ms, 8ms};      ///< thresholds of the filtered force [N]
  Bit<>::Settings squeezed{1.45, 1.33, 8ms, 8ms};    ///< thresholds of force over holding force
  double carried = 0.015;                            ///< distance since contact, of a carried object [m]
  double grasp_reach = 0.15;                         ///< largest distance of an object that a hand takes [m]
  std::uint64_t tools = 0;                           ///< bit k: objects of class k < 64 are tools
  double tool_near = 0.15, tool_far = 0.16;          ///< nearness to a tool: begin and end distance [m]
  double left_stopped = 0.02;  ///< distance at which a hand that stopped has left what it released [m]
  double left_heading = 0.06;  ///< distance at which a hand heading for another object has left it [m]
  double heading = 0.95;  ///< cosine between velocity and direction from which a hand heads for an object
  Nanoseconds left_after = 1500ms;  ///< time after a release at which a hand has left it in any case
  Nanoseconds max_gap = 100ms;      ///< time without a sample after which the hand is unknown
};

/// Features from samples of a hand and a world of objects.
///
/// | bit | holds while |
/// |---|---|
/// | moving | the hand is faster than 0.035 m/s for 10 ms, until slower than 0.025 for 20 ms |
/// | in_hand | the fingers press with 0.5 N for 8 ms, until with less than 0.25 N for 8 ms |
/// | carried | the hand has moved by 15 mm since contact; until release |
/// | squeezed | if carried: 1.45 times the holding force (its maximum until carried), until below 1.33 |
/// | tool | what is held is a tool, and another object is nearer than 0.15 m |
/// | left | after a release: stopped after 20 mm; or 60 mm off, heading for another object; or after 1.5 s |
///
/// The object in hand is the nearest one when contact began. A sample is `known` if the signals suffice:
/// three deviations of the speed, as follow from those of the positions and their rate, are below the
/// threshold at which a hand stands. A hand that only a camera sees is unknown, and so is one whose fingers
/// do not feel.
template <Frame W = World>
class FeatureExtractor {
 public:
  struct Memory {
    SpeedEstimate<>::Memory speed{};
    LowPass<double>::Memory force{};
    Bit<>::Memory moving{}, in_hand{}, squeezed{}, tool{};
    Features last{};
    Xyz<double> begun{0, 0, 0};        ///< position of the hand where contact began or ended, in W [m]
    Xyz<double> p{0, 0, 0};            ///< position of the hand in W [m]
    Xyz<double> touched{0, 0, 0};      ///< position of the hand when the fingers began to press, in W [m]
    Nanoseconds changed{};             ///< time at which contact began or ended
    double period = 0;                 ///< filtered period of the samples [s]
    double holding = 0;                ///< largest force until the object was carried [N]
    std::uint8_t nearest = no_object;  ///< object nearest to the hand when the fingers began to press
    std::uint8_t released = no_object;
    bool started = false;
  };

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD explicit FeatureExtractor(const FeatureSettings& s = {})
      : s_(s),
        speed_(s.speed),
        force_(s.force_filter),
        moving_(s.moving),
        in_hand_(s.in_hand),
        squeezed_(s.squeezed),
        tool_({-s.tool_near, -s.tool_far, 0ns, 0ns}) {
    const auto length = [](double x, const char* name) {
      require(x > 0 && x <= 100, name, x, "> 0, <= 100 m");
    };
    require(s.moving.off > 0, "Features: moving off", s.moving.off, "> 0 m/s");
    require(s.in_hand.off > 0, "Features: in_hand off", s.in_hand.off, "> 0 N");
    require(s.squeezed.off > 1, "Features: squeezed off", s.squeezed.off, "> 1");
    length(s.carried, "Features: carried");
    length(s.grasp_reach, "Features: grasp_reach");
    length(s.tool_near, "Features: tool_near");
    length(s.left_stopped, "Features: left_stopped");
    length(s.left_heading, "Features: left_heading");
    require(s.heading > 0 && s.heading <= 1, "Features: heading", s.heading, "> 0, <= 1");
    require(s.left_after > 0ns && s.left_after <= 1000s, "Features: left_after", milliseconds(s.left_after),
            "> 0, <= 1e6 ms");
    require(s.max_gap > 0ns && s.max_gap <= 10s, "Features: max_gap", milliseconds(s.max_gap),
            "> 0, <= 1e4 ms");
  }
  [[nodiscard]] const FeatureSettings& settings() const noexcept { return s_; }

  /// Whether positions of deviation `sigma` [m], one every `period`, suffice to tell a hand at rest from one
  /// that moves.
  [[nodiscard]] bool suffices(double sigma, Nanoseconds period) const noexcept {
    return 3 * speed_.noise(sigma, period) <= s_.moving.off;
  }

  /// Takes a sample of the hand and returns the features; the world's held object follows the hand. A sample
  /// that is not finite or older than the last one changes nothing but `known`, which is false then.
  template <std::size_t Capacity>
  Features step(Memory& m, const ObjectWorld<Capacity, W>& world,
                typename ObjectWorld<Capacity, W>::Memory& objects,
                const HandSample<W>& hand) const noexcept {
    Features& f = m.last;
    const Xyz<double> p = hand.X_WH.origin();
    const double size = dot(p, p);
    if (!(size <= 1e12) || !detail::is_plausible(hand.time) || (m.started && hand.time <= f.time)) {
      f.known = f.known && m.started && hand.time == f.time && size <= 1e12;
      return f;
    }
    const double dt = m.started ? seconds<double>(hand.time - f.time) : 0;
    m.period = m.period > 0 && dt <= 10 * m.period ? m.period + 0.1 * (dt - m.period) : dt;
    static_cast<void>(speed_.step(m.speed, hand.time, p));
    f.event = m.started ? f.event : hand.time;
    f.time = hand.time;
    const bool feels = hand.force - hand.force == 0;
    if (feels) static_cast<void>(force_.sample(m.force, hand.time, hand.force));
    f.known = feels && m.started && seconds<double>(s_.max_gap) >= dt && hand.sigma >= 0 &&
              suffices(hand.sigma, Nanoseconds(static_cast<std::int64_t>(m.period * 1e9)));
    m.started = true;
    m.p = p;
    f.speed = norm(m.speed.v);
    f.force = m.force.output;

    if (flipped(moving_, m.moving, f.time, f.speed)) changed(f, m.moving.since - speed_.lag());
    f.moving = m.moving.on;
    contact(m, world, objects, hand);
    follow(m, world, objects, hand);
    return f;
  }

 private:
  static bool flipped(const Bit<>& bit, Bit<>::Memory& m, Nanoseconds time, double x) noexcept {
    const bool was = m.on;
    static_cast<void>(bit.step(m, time, x));
    return m.on != was;
  }
  static void changed(Features& f, Nanoseconds at) noexcept { f.event = at > f.event ? at : f.event; }

  /// Updates the contact, where it begins or ends.
  template <class Objects, class Known>
  void contact(Memory& m, const Objects& world, Known& objects, const HandSample<W>& hand) const noexcept {
    Features& f = m.last;
    const bool pressed = m.in_hand.pending && !m.in_hand.on;
    const bool flips = flipped(in_hand_, m.in_hand, f.time, f.force);
    if (!f.in_hand && !pressed && (m.in_hand.pending || m.in_hand.on)) {  // the fingers begin to press
      m.touched = m.p;
      m.nearest = world.nearest(objects, m.p, s_.grasp_reach).object;
    }
    if (!flips) return;
    f.in_hand = m.in_hand.on;
    changed(f, m.in_hand.since);
    m.changed = m.in_hand.since;
    f.carried = f.squeezed = false;
    if (f.in_hand) {
      m.begun = m.touched;
      m.holding = 0;
      f.held = m.nearest;
      f.held_kind = f.held < Objects::capacity ? objects.objects[f.held].kind : ObjectClass(0);
      world.grasp(objects, f.held, hand.X_WH);
    } else {
      m.begun = m.p;
      m.released = f.held;
      f.left = false;
      world.release(objects, m.in_hand.since);
    }
  }

  /// Updates the features that follow from the place of the hand.
  template <class Objects, class Known>
  void follow(Memory& m, const Objects& world, Known& objects, const HandSample<W>& hand) const noexcept {
    Features& f = m.last;
    f.moved = norm(Xyz<double>(m.p - m.begun));
    const double elapsed = seconds<double>(f.time - m.changed);
    f.elapsed = elapsed < 10 ? elapsed : 10;
    if (f.in_hand) {
      world.carry(objects, hand.X_WH);
      if (!f.carried) m.holding = f.force > m.holding ? f.force : m.holding;
      if (!f.carried && f.moved > s_.carried) {
        f.carried = true;
        changed(f, f.time);
        Bit<>::set(m.squeezed, false, f.time);
      }
      f.ratio = m.holding > 0 ? f.force / m.holding : 0;
      if (f.carried && flipped(squeezed_, m.squeezed, f.time, f.ratio)) changed(f, m.squeezed.since);
      f.squeezed = f.carried && m.squeezed.on;
    } else {
      f.ratio = 0;
      if (!f.left) leave(m, world, objects);
    }
    const auto near = world.nearest(objects, m.p, 10, f.in_hand ? f.held : no_object);
    f.near = near.object;
    f.near_kind = near.object < Objects::capacity ? objects.objects[near.object].kind : ObjectClass(0);
    f.near_distance = near.distance;
    const bool wields = f.in_hand && f.held_kind < 64 && ((s_.tools >> f.held_kind) & 1u) != 0;
    if (flipped(tool_, m.tool, f.time, wields ? -near.distance : -1e3)) changed(f, f.time);
    f.tool = m.tool.on;
  }

  /// Updates `left`: whether the hand goes away from the object that it released.
  template <class Objects, class Known>
  void leave(Memory& m, const Objects&, const Known& objects) const noexcept {
    Features& f = m.last;
    bool left = f.time - m.changed >= s_.left_after || (!f.moving && f.moved >= s_.left_stopped);
    if (!left && f.moving && f.moved > s_.left_heading)
      for (std::size_t i = 0; i < Objects::capacity; ++i) {
        if (i == m.released || !objects.objects[i].known) continue;
        const Xyz<double> way = objects.objects[i].X_WO.origin() - m.p;
        left = left || dot(way, m.speed.v) > s_.heading * norm(way) * f.speed;
      }
    if (left) changed(f, f.time);
    f.left = left;
  }

  FeatureSettings s_;
  SpeedEstimate<> speed_;
  LowPass<double> force_;
  Bit<> moving_, in_hand_, squeezed_, tool_;
};

SKINCTL_END_NAMESPACE

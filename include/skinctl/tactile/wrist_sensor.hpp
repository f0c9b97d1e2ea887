// SPDX-License-Identifier: BSD-3-Clause
// A force-torque sensor as touch: the wrench that it measures acts on the link that carries it.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "skinctl/core/state.hpp"
#include "skinctl/frames/transform.hpp"
#include "skinctl/kinematics/poses.hpp"
#include "skinctl/sensing/cell_sample.hpp"
#include "skinctl/sensing/sample_span.hpp"
#include "skinctl/sensing/wrench_sample.hpp"
#include "skinctl/tactile/detail/base_seen.hpp"
#include "skinctl/tactile/detail/sampled_row.hpp"
#include "skinctl/tactile/detail/touch_rows.hpp"
#include "skinctl/tactile/link_wrenches.hpp"
#include "skinctl/tactile/push_watch.hpp"
#include "skinctl/tactile/skin_torque.hpp"
#include "skinctl/tactile/touch_sum.hpp"
#include "skinctl/tactile/wrist_sensor_settings.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The addition of a wrist sensor to the input of a cycle.
struct WristInput {
  SampleSpan<WrenchSample> wrenches;  ///< samples since the last cycle, in the order of their stamps
};

/// A force-torque sensor on link `Ix` of the model `M`, in place of a skin or beside one:
///
///     Cycle(arm, wrist_sensor<5>(model, {...}), law)
///     Cycle(arm, skin + wrist_sensor<5>(model, {...}), law)
///
/// Laws see its wrench as they see that of a skin on link `Ix`: an arm without skin gives way at its tool.
///
/// **Reading.** `w = gain gate(sample - bias - weight)`. `weight` is the gravity of `mass` at `centre` at the
/// measured pose, and what a moving base (`OnMovingBase`) does to it; the inertial force of an accelerated
/// arm is not taken off (1 N for 1 kg at 1 m/s^2: choose the thresholds above it). The gates act on |force|
/// and |moment|; the default ones subtract 2 N and 0.2 N m, so that a push ends without a step.
///
/// **Time.** The wrench is linear in time through its stamped samples, or constant until `ramp` before the
/// next one where they are further apart, and is held after the last; from `max_age - fade` on it goes to
/// zero. The impulse of a change that only a later sample shows is added then, up to `catch_up` back.
///
/// **Bias.** `tared` finds it at the start. With `noise` declared a push has to live, as a hand's does: a
/// bias that creeps or jumps moves the arm by 8 mm, is reported (`push_without_life`), and becomes the
/// reading of rest once the arm stands. So does a weight that hangs on the tool, and a push of a few newtons
/// without any tremor.
///
/// What the skin beyond the sensor feels, the sensor feels too: leave one of them out. A single wrench is one
/// contact, with a lever no longer than the link's reach (see `contacts_of`).
template <std::size_t Ix, RobotModel M, Real T = double>
class WristSensor : public sensor_sums::Summand {
 public:
  static_assert(Ix < M::joints, "a wrist sensor on a link that the model does not have");
  using scalar = T;
  using Wrenches = LinkWrenches<M, link_bit<Ix>, T>;
  using Sensed = WristInput;
  using Settings = WristSensorSettings<Ix>;
  using Watch = PushWatch<6, 2>;
  static constexpr std::size_t link = Ix;
  static constexpr LinkMask links = Wrenches::links;
  using OnBase = detail::BaseSeen<M, T>;
  /// Trivially copyable; only the sensor reads and writes its members.
  struct Memory {
    detail::SampledRow<6, T> row;  ///< wrench on the link, about the link's origin [N], [N m]
    bool force_gate_open = false, moment_gate_open = false;  ///< whether the gates let a reading pass
    typename Watch::Memory watch;       ///< watch for pushes without life, along the sensor's axes
    State<M::joints, T> followed;       ///< robot's state when the way given to a push was last counted
    [[no_unique_address]] OnBase base;  ///< motion of a base that moves
    friend bool operator==(const Memory&, const Memory&) noexcept = default;
  };

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD WristSensor(const M& model, const Settings& settings)
      : model_(model),
        s_(settings),
        watch_(s_.life, {s_.noise, s_.moment_noise}, creep_of(s_.creep, s_.creep * s_.reach)) {
    const auto finite = [](const Xyz<double>& v, double most, const char* what) {
      for (const double x : {v.x, v.y, v.z})
        require(x >= -most && x <= most, what, x, "finite, within range");
    };
    require(s_.mass >= 0 && s_.mass <= 1000, "WristSensor: mass", s_.mass, "0 to 1000 kg");
    const Xyz<T> g = dense<T>(model_.template gravity<T>());
    require(s_.mass == 0 || dot(g, g) > T(0), "WristSensor: mass", s_.mass,
            "0 kg for a model without gravity: name the model that has it");
    for (const auto& x : {s_.centre, s_.X_LS.origin()}) finite(x, 10, "WristSensor: centre, or X_LS [m]");
    require(s_.reach >= 0 && s_.reach <= 10, "WristSensor: reach", s_.reach, "0 to 10 m");
    require(s_.gain > 0 && s_.gain <= 1000, "WristSensor: gain", s_.gain, "> 0, <= 1000");
    require(s_.max_force > 0 && s_.max_force <= 1e6, "WristSensor: max_force", s_.max_force, "> 0, <= 1e6 N");
    require(s_.max_moment > 0 && s_.max_moment <= 1e6, "WristSensor: max_moment", s_.max_moment,
            "> 0, <= 1e6 N m");
    finite(s_.bias.force, s_.max_force, "WristSensor: bias [N]");
    finite(s_.bias.moment, s_.max_moment, "WristSensor: bias [N m]");
    require(s_.fade > 0ns, "WristSensor: fade", milliseconds(s_.fade), "> 0 ms");
    require(s_.max_age >= s_.fade && s_.max_age <= 10s, "WristSensor: max_age", milliseconds(s_.max_age),
            ">= fade, <= 10 s [ms]");
    require(s_.ramp > 0ns && s_.ramp <= 10s, "WristSensor: ramp", milliseconds(s_.ramp), "> 0 ms, <= 10 s");
    require(s_.catch_up >= 0ns, "WristSensor: catch_up", milliseconds(s_.catch_up), ">= 0 ms");
    require(s_.max_ahead >= 0ns && s_.max_ahead <= 1s, "WristSensor: max_ahead", milliseconds(s_.max_ahead),
            "0 ms to 1 s");
  }
  [[nodiscard]] const Settings& settings() const noexcept { return s_; }

  /// The same sensor with the bias that these samples show: taken while nobody touches the tool and the arm
  /// stands at `q`. Throws `ConfigurationError` for fewer than 10 samples, for one that is not valid, and if
  /// a sample differs from their mean by more than half of the threshold of force or moment (somebody
  /// touches, or the sensor is noisier than its thresholds).
  [[nodiscard]] SKINCTL_COLD WristSensor tared(std::span<const WrenchSample> at_rest,
                                               const JointPosition<M::joints, T>& q) const {
    require(at_rest.size() >= 10, "WristSensor: samples at rest", double(at_rest.size()), ">= 10");
    const auto force = [](const WrenchSample& s) { return Xyz<double>{s.force[0], s.force[1], s.force[2]}; };
    const auto moment = [](const WrenchSample& s) {
      return Xyz<double>{s.moment[0], s.moment[1], s.moment[2]};
    };
    const double share = 1 / double(at_rest.size());
    Wrench<ForceSensor> mean;
    for (const WrenchSample& s : at_rest) {
      require(!check(s, s_.max_force, s_.max_moment).any(), "WristSensor: a component of force at rest",
              s.force[2], "within the sensor's range [N]");
      mean.force = mean.force + share * force(s);
      mean.moment = mean.moment + share * moment(s);
    }
    const auto far = [](const Xyz<double>& x) { return std::sqrt(dot(x, x)); };
    for (const WrenchSample& s : at_rest) {
      const double df = far(force(s) - mean.force), dm = far(moment(s) - mean.moment);
      require(df <= 0.5 * s_.force.opens_at(), "WristSensor: change of force at rest", df,
              "<= half of its threshold [N]");
      require(dm <= 0.5 * s_.moment.opens_at(), "WristSensor: change of moment at rest", dm,
              "<= half of its threshold [N m]");
    }
    Settings settings = s_;
    settings.bias = mean - weight(q, OnBase::start(model_));
    return WristSensor(model_, settings);
  }

  /// A sample from a wrench at the sensor's origin along the axes of the base, force first: a UR's
  /// `actual_TCP_force`, with `X_LS` the pose of its TCP on the last link, `mass` 0 (the controller takes its
  /// payload off), and `q` its `actual_q` of the same package.
  [[nodiscard]] WrenchSample from_base_axes(Nanoseconds time, const std::array<double, 6>& wrench,
                                            const JointPosition<M::joints, T>& q) const noexcept {
    const auto R_SB = axes_in_base(q).transpose();
    const Xyz<double> f = R_SB * Xyz<double>{wrench[0], wrench[1], wrench[2]};
    const Xyz<double> m = R_SB * Xyz<double>{wrench[3], wrench[4], wrench[5]};
    return {time, {f.x, f.y, f.z}, {m.x, m.y, m.z}};
  }

  [[nodiscard]] Memory start(Nanoseconds now) const noexcept {
    Memory memory;
    memory.row.begin = now;
    memory.base = OnBase::start(model_);
    return memory;
  }
  /// The reading of rest that was found while running, beyond `Settings::bias`.
  [[nodiscard]] static Wrench<ForceSensor> bias(const Memory& memory) noexcept {
    const auto& b = memory.watch.bias;
    return {{b[0], b[1], b[2]}, {b[3], b[4], b[5]}};
  }
  /// Counts how far the arm gives way to a push; called by a scene.
  template <class Model, class State>
  void follow_robot(Memory& m, const Model& model, const State& state) const noexcept {
    m.base.take(model);
    watch_.follow_robot(m.watch, m.followed, state, [&] {
      if (!m.force_gate_open && !m.moment_gate_open) return 0.0;
      const T* w = m.row.held;
      const double force = std::sqrt(double(w[0] * w[0] + w[1] * w[1] + w[2] * w[2])),
                   moment = std::sqrt(double(w[3] * w[3] + w[4] * w[4] + w[5] * w[5]));
      const double push = std::max(force, moment / std::max(s_.reach, shortest_reach));
      const JointTorque<M::joints, T> tau = skin_torque(model_, state.q, wrenches(m));
      double work = 0;
      for (std::size_t i = 0; i < M::joints; ++i) work += double(tau[i] * (state.q[i] - m.followed.q[i]));
      return push > Watch::min_push ? work / push : 0.0;
    });
  }

  /// Takes the samples that arrived and gives the mean wrench over each of `parts` >= 1 equal parts of the
  /// interval `(from, to]`, as `Skin::receive` does. Ignored and reported: a sample that is not finite or
  /// beyond the sensor's range (`sample_not_finite`, `sample_out_of_range`), not later than the last one
  /// (`time_backwards`), more than `max_ahead` after `to` (`sample_out_of_range`), or older than `max_age`
  /// (`sample_stale`, which is also reported while the sensor is silent).
  ///
  /// @param cells     samples of cells, which this sensor does not have: reported as `sample_unknown`.
  /// @param measured  the newest good state of the robot, for the weight.
  Status receive(Memory& memory, std::span<const CellSample> cells, const WristInput& input,
                 const State<M::joints, T>& measured, Nanoseconds from, Nanoseconds to, std::size_t parts,
                 Wrenches* means) const noexcept {
    SKINCTL_EXPECTS(parts > 0 && means != nullptr, "at least one part of the interval");
    const auto row = [means](std::size_t j) SKINCTL_INLINE_LAMBDA -> T* { return means[j].data[0]; };
    const detail::SampledTimes times{s_.max_age, s_.fade, s_.ramp, s_.catch_up, s_.max_ahead};
    detail::SampledInterval<6, T, decltype(row)> interval(times, memory.row, from, to, parts, row);
    Status status = cells.empty() ? Status{} : Status{Reason::sample_unknown};
    if (!input.wrenches.empty()) {
      const Wrench<ForceSensor> load = weight(measured.q, memory.base);
      for (const WrenchSample& sample : input.wrenches) {
        Status bad = check(sample, s_.max_force, s_.max_moment);
        if (!bad.any()) bad = interval.admits(sample.time);
        status |= bad;
        if (bad.any()) continue;
        T value[6];
        take(memory, sample, load, value);
        interval.take(sample.time, value);
      }
    }
    if (interval.end()) {
      memory.force_gate_open = memory.moment_gate_open = false;
      status |= Reason::sample_stale;
    }
    return status | watch_.settle(memory.watch, to);
  }

  /// The wrench of the last sample; zero once the sensor is silent.
  [[nodiscard]] Wrenches wrenches(const Memory& memory) const noexcept {
    Wrenches out;
    for (std::size_t r = 0; r < 6; ++r) out.data[0][r] = memory.row.held[r];
    return out;
  }
  /// Calls `f(link, force, moment, gain)` for pushes of one newton on the tool, at the sensor's origin and at
  /// its reach: the wrench on the link about its origin, and the newtons that laws see.
  template <class F>
  void each_point(F&& f) const {
    const Xyz<double> axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const auto push = [&](const Xyz<double>& p, const Xyz<double>& n) {
      const auto F_L = transformed(s_.X_LS, Wrench<ForceSensor>{n, cross(p, n)});
      f(Ix, skinctl::cast<T>(F_L.force), skinctl::cast<T>(F_L.moment), s_.gain);
    };
    for (int along = 0; along < 3; ++along) {
      push({0, 0, 0}, axes[along]);
      for (int side = 1; side < 3; ++side)
        for (const double far : {-s_.reach, s_.reach}) push(far * axes[along], axes[(along + side) % 3]);
    }
  }

 private:
  static constexpr double shortest_reach = 0.01;  ///< lever by which a moment alone counts as a force [m]
  /// R_BS: the axes of the sensor as vectors of the base, at `q`.
  [[nodiscard]] Rotation<double> axes_in_base(const JointPosition<M::joints, T>& q) const noexcept {
    const JointAngles<M, T, link_bit<Ix>> angles(model_, q);
    const Poses<M, link_bit<Ix>, T> poses(model_, angles);
    return poses.template get<Ix>().template cast<double>().axes() * s_.X_LS.axes();
  }
  /// Gravity of the load, and the base's motion, along the sensor's axes, about its origin [N], [N m].
  [[nodiscard]] Wrench<ForceSensor> weight(const JointPosition<M::joints, T>& q,
                                           [[maybe_unused]] const OnBase& base) const noexcept {
    if (s_.mass == 0) return {};
    Xyz<T> g = dense<T>(model_.template gravity<T>());
    if constexpr (base_moves<M>) {
      const auto X_BS = link_poses<link_bit<Ix>>(model_, q).template get<Ix>() * s_.X_LS.template cast<T>();
      g = -acceleration_at(base.motion, Xyz<T>(X_BS.origin() + X_BS.axes() * skinctl::cast<T>(s_.centre)));
    }
    const Xyz<double> force = s_.mass * (axes_in_base(q).transpose() * skinctl::cast<double>(g));
    return {force, cross(s_.centre, force)};
  }
  /// Puts a reading behind the gates into `out`, as the wrench on the link about its origin [N], [N m].
  SKINCTL_INLINE void take(Memory& memory, const WrenchSample& sample, const Wrench<ForceSensor>& weight,
                           T (&out)[6]) const noexcept {
    const auto gated = [](const EventGate<>& gate, const Xyz<double>& x, bool& open) SKINCTL_INLINE_LAMBDA {
      const double size = std::sqrt(dot(x, x)), passed = gate.pass(size, open);
      open = passed > 0;
      return open ? (passed / size) * x : Xyz<double>{0, 0, 0};
    };
    const Xyz<double> f{sample.force[0], sample.force[1], sample.force[2]};
    const Xyz<double> m{sample.moment[0], sample.moment[1], sample.moment[2]};
    Wrench<ForceSensor> F;
    const auto rest = s_.bias + weight + bias(memory);
    const Xyz<double> df = f - rest.force, dm = m - rest.moment;
    F.force = gated(s_.force, df, memory.force_gate_open);
    F.moment = gated(s_.moment, dm, memory.moment_gate_open);
    const double force = std::sqrt(dot(F.force, F.force)), moment = std::sqrt(dot(F.moment, F.moment));
    watch_.take(
        memory.watch, {df.x, df.y, df.z, dm.x, dm.y, dm.z}, {std::sqrt(dot(df, df)), std::sqrt(dot(dm, dm))},
        static_cast<std::uint16_t>((memory.force_gate_open ? 1 : 0) | (memory.moment_gate_open ? 2 : 0)));
    const double share =
        s_.gain * watch_.share(memory.watch, std::max(force, moment / std::max(s_.reach, 0.01)));
    F.force = share * F.force;
    F.moment = share * F.moment;
    const auto on_link = transformed(s_.X_LS, F);
    const Xyz<T> F_L = skinctl::cast<T>(on_link.force), M_L = skinctl::cast<T>(on_link.moment);
    out[0] = F_L.x, out[1] = F_L.y, out[2] = F_L.z;
    out[3] = M_L.x, out[4] = M_L.y, out[5] = M_L.z;
  }

  static std::array<double, 6> creep_of(double force, double moment) noexcept {
    return {force, force, force, moment, moment, moment};
  }

  [[no_unique_address]] M model_;
  Settings s_;
  Watch watch_;
};

/// `wrist_sensor<5>(model, {...})`: a sensor on link 5 of the robot with that model.
template <std::size_t Ix, Real T = double, RobotModel M>
[[nodiscard]] WristSensor<Ix, M, T> wrist_sensor(const M& model,
                                                 const WristSensorSettings<Ix>& settings = {}) {
  return {model, settings};
}

SKINCTL_END_NAMESPACE

// SPDX-License-Identifier: BSD-3-Clause
// Motions that show a robot's axes, the places of its cells and its masses: within its limits, and announced.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "skinctl/calibration/detail/eigen_only.hpp"
#include "skinctl/calibration/joint_motion.hpp"
#include "skinctl/core/joint.hpp"
#include "skinctl/dynamics/inverse_dynamics.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The limits of the joints in an excitation.
struct ExcitationLimits {
  Eigen::VectorXd lower, upper;            ///< position limits [rad]
  Eigen::VectorXd velocity, acceleration;  ///< velocity and acceleration limits [rad/s], [rad/s^2]
  Eigen::VectorXd torque{};                ///< torque limits [N m]; empty: not asked for
};

/// A part of an excitation, in words for those who stand near the robot.
struct Announcement {
  double begin = 0, end = 0;  ///< beginning and end [s]
  int joint = -1;             ///< index of the joint that moves alone; -1: all joints move
  std::string text;
};

namespace detail::fit {
/// A sum of sines that begins and ends at rest.
struct RisingSines {
  double from = 0, to = 1, rise = 1;
  std::vector<double> rate, sine, cosine;  ///< rates [rad/s] and amplitudes [rad] of the sines

  struct Value {
    double x = 0, v = 0, a = 0;
  };
  [[nodiscard]] Value at(double t) const noexcept {
    if (!(t > from && t < to)) return {};
    const auto edge = [&](double since, double sign) -> Value {
      const double r = since / rise;
      if (r >= 1) return {1, 0, 0};
      return {r * r * r * (10 + r * (6 * r - 15)), sign * 30 * r * r * (1 - r) * (1 - r) / rise,
              60 * r * (1 - r) * (1 - 2 * r) / (rise * rise)};
    };
    const Value up = edge(t - from, 1), down = edge(to - t, -1);
    const Value w{up.x * down.x, up.v * down.x + up.x * down.v,
                  up.a * down.x + 2 * up.v * down.v + up.x * down.a};
    Value f;
    for (std::size_t k = 0; k < rate.size(); ++k) {
      const double s = std::sin(rate[k] * (t - from)), c = std::cos(rate[k] * (t - from));
      f.x += sine[k] * s + cosine[k] * c;
      f.v += rate[k] * (sine[k] * c - cosine[k] * s);
      f.a -= rate[k] * rate[k] * (sine[k] * s + cosine[k] * c);
    }
    return {w.x * f.x, w.v * f.x + w.x * f.v, w.a * f.x + 2 * w.v * f.v + w.x * f.a};
  }
};
}  // namespace detail::fit

/// A planned motion: sums of sines about home, each of which begins and ends at rest.
class Excitation {
 public:
  [[nodiscard]] double duration() const noexcept { return duration_; }
  [[nodiscard]] int joints() const noexcept { return int(home_.size()); }
  [[nodiscard]] const Eigen::VectorXd& home() const noexcept { return home_; }
  /// Positions, velocities and accelerations of the joints `t` seconds after the start; at rest at home
  /// before it and after the end.
  [[nodiscard]] JointPoint at(double t) const {
    JointPoint p{home_, Eigen::VectorXd::Zero(home_.size()), Eigen::VectorXd::Zero(home_.size())};
    for (Eigen::Index j = 0; j < home_.size(); ++j)
      for (const auto& part : parts_[std::size_t(j)]) {
        const auto v = part.at(t);
        p.q(j) += v.x, p.dq(j) += v.v, p.ddq(j) += v.a;
      }
    return p;
  }
  /// The joints that will move, with times, angles and speeds. Read them out, or show them, before the robot
  /// moves.
  [[nodiscard]] const std::vector<Announcement>& announcements() const noexcept { return announcements_; }

  /// The largest share of a limit that the motion uses: position (of the room from home), velocity,
  /// acceleration.
  [[nodiscard]] double largest_share(const ExcitationLimits& limits) const {
    double worst = 0;
    for (double t = 0; t < duration_; t += 0.004) {
      const JointPoint p = at(t);
      for (Eigen::Index j = 0; j < home_.size(); ++j) {
        const double d = p.q(j) - home_(j);
        const double room = d > 0 ? limits.upper(j) - home_(j) : home_(j) - limits.lower(j);
        worst = std::max({worst, std::abs(d) / room, std::abs(p.dq(j)) / limits.velocity(j),
                          std::abs(p.ddq(j)) / limits.acceleration(j)});
      }
    }
    return worst;
  }
  /// The largest torque of a joint by a model without friction, as a share of its `limit` [N m].
  template <RobotModel M>
  [[nodiscard]] double torque_share(const M& model, const Eigen::VectorXd& limit) const {
    constexpr std::size_t N = M::joints;
    require(home_.size() == Eigen::Index(N) && limit.size() == Eigen::Index(N), "joints of the model",
            double(N), "as many as of the motion");
    double worst = 0;
    JointPosition<N> q;
    JointVelocity<N> dq;
    JointAcceleration<N> ddq;
    for (double t = 0; t < duration_; t += 0.02) {
      const JointPoint p = at(t);
      for (std::size_t i = 0; i < N; ++i)
        q[i] = p.q(Eigen::Index(i)), dq[i] = p.dq(Eigen::Index(i)), ddq[i] = p.ddq(Eigen::Index(i));
      const auto tau = yr_theta(model, q, dq, dq, ddq);
      for (std::size_t i = 0; i < N; ++i) worst = std::max(worst, std::abs(tau[i]) / limit(Eigen::Index(i)));
    }
    return worst;
  }

 protected:
  Eigen::VectorXd home_;
  double duration_ = 0;
  std::vector<std::vector<detail::fit::RisingSines>> parts_;
  std::vector<Announcement> announcements_;

  static void check(const Eigen::VectorXd& home, const ExcitationLimits& limits) {
    require(home.size() >= 1 && limits.lower.size() == home.size() && limits.upper.size() == home.size() &&
                limits.velocity.size() == home.size() && limits.acceleration.size() == home.size(),
            "joints of the limits", double(limits.lower.size()), "as many as of home");
    for (Eigen::Index j = 0; j < home.size(); ++j) {
      const double room = std::min(home(j) - limits.lower(j), limits.upper(j) - home(j));
      require(room > 0.1, "room about home [rad]", room, "> 0.1 rad to both limits, of each joint");
      require(limits.velocity(j) > 0.05, "velocity limit", limits.velocity(j), "> 0.05 rad/s");
      require(limits.acceleration(j) > 0.2, "acceleration limit", limits.acceleration(j), "> 0.2 rad/s^2");
    }
  }
  static constexpr int all_joints = -1;
  /// Adds to `announcements` in words what `joint`, or `all_joints`, does from `from` to `to` [s].
  void announce(double from, double to, int joint) {
    double way = 0, speed = 0;
    for (double t = from; t < to; t += 0.01) {
      const JointPoint p = at(t);
      way = std::max(way, (p.q - home_).cwiseAbs().maxCoeff());
      speed = std::max(speed, p.dq.cwiseAbs().maxCoeff());
    }
    char text[200];
    const std::string who = joint < 0 ? "all joints" : "joint " + std::to_string(joint) + " alone";
    std::snprintf(text, sizeof text, "%.0f to %.0f s: %s, up to %.0f degrees from home, up to %.0f degrees/s",
                  from, to, who.c_str(), way * 57.29578, speed * 57.29578);
    announcements_.push_back({from, to, joint, text});
  }
};

/// The motion for `find_joint_lines`: each joint alone, then all together, each sweeping slowly (gravity) and
/// wiggling (acceleration). Of 60 s, a UR5: 6 x 4 s alone, 36 s together.
class SkinExcitation : public Excitation {
 public:
  struct Settings {
    double duration = 60;  ///< duration of the motion [s], 20 to 3600; two fifths for single joints
    double sweep = 1;      ///< amplitude of the slow sweep [rad]
    double wiggle = 1;     ///< amplitude of the wiggle's speed [rad/s]
    double share = 0.9;    ///< share of each limit that may be used, 0.1 to 1
  };
  /// Throws `ConfigurationError` for a home less than 0.1 rad from a limit, and for numbers out of their
  /// range.
  SkinExcitation(const Eigen::VectorXd& home, const ExcitationLimits& limits, const Settings& s) {
    plan(home, limits, s);
  }
  SkinExcitation(const Eigen::VectorXd& home, const ExcitationLimits& limits)
      : SkinExcitation(home, limits, Settings{}) {}
  /// A motion within the torque limits as well, by a model with masses: it wiggles less where they would be
  /// exceeded. Throws `ConfigurationError` also where that does not suffice.
  template <RobotModel M>
  SkinExcitation(const Eigen::VectorXd& home, const ExcitationLimits& limits, Settings s, const M& model) {
    plan(home, limits, s);
    for (int tries = 0; tries < 12 && torque_share(model, limits.torque) > s.share; ++tries) {
      s.wiggle *= 0.8;
      plan(home, limits, s);
    }
    const double share = torque_share(model, limits.torque);
    require(share <= s.share, "share of the torque limits", share,
            "<= the share that may be used: choose another home");
  }

 private:
  void plan(const Eigen::VectorXd& home, const ExcitationLimits& limits, const Settings& s) {
    check(home, limits);
    require(s.duration >= 20 && s.duration <= 3600, "duration", s.duration, "20 to 3600 s");
    require(s.sweep > 0.01 && s.sweep <= 3, "sweep", s.sweep, "0.01 to 3 rad");
    require(s.wiggle > 0.01 && s.wiggle <= 5, "wiggle", s.wiggle, "0.01 to 5 rad/s");
    require(s.share >= 0.1 && s.share <= 1, "share of the limits", s.share, "0.1 to 1");
    home_ = home, duration_ = s.duration;
    parts_.assign(std::size_t(home.size()), {});
    announcements_.clear();
    const auto n = home.size();
    constexpr double two_pi = 6.283185307179586;
    const double single = 0.4 * s.duration / double(n), together = 0.4 * s.duration;
    for (Eigen::Index j = 0; j < n; ++j) {
      const double x = n > 1 ? double(j) / double(n - 1) : 0.5;
      const double phase = 2.399963 * double(j);
      const double room = s.share * std::min(home(j) - limits.lower(j), limits.upper(j) - home(j));
      const auto part = [&](double from, double to, double rise, double slow, double fast) {
        detail::fit::RisingSines out{from, to, rise, {two_pi * slow, two_pi * fast}, {0, 0}, {0, 0}};
        const double quick = std::min({s.wiggle, 0.5 * s.share * limits.velocity(j),
                                       0.75 * s.share * limits.acceleration(j) / out.rate[1]}) /
                             out.rate[1];
        const double most = std::min({s.sweep, room, 0.45 * s.share * limits.velocity(j) / out.rate[0],
                                      0.2 * s.share * limits.acceleration(j) / (out.rate[0] * out.rate[0])});
        const double wide = std::max(0.2 * most, most - quick);
        out.sine = {wide * std::cos(phase), quick * std::cos(1.7 * phase)};
        out.cosine = {wide * std::sin(phase), quick * std::sin(1.7 * phase)};
        // Rise and sum: what is left is scaled.
        double over = 1;
        for (double t = from; t < to; t += 0.004) {
          const auto v = out.at(t);
          over = std::max({over, std::abs(v.x) / room, std::abs(v.v) / (s.share * limits.velocity(j)),
                           std::abs(v.a) / (s.share * limits.acceleration(j))});
        }
        for (int k = 0; k < 2; ++k) out.sine[std::size_t(k)] /= over, out.cosine[std::size_t(k)] /= over;
        return out;
      };
      const double at = single * double(j);
      auto& own = parts_[std::size_t(j)];
      own.push_back(part(at, at + single, std::min(1.0, single / 4), 1.3 / single, 2));
      own.push_back(
          part(together, s.duration, 1.5, 0.04 + 0.08 * x, 1.5 + std::fmod(0.618 * double(j), 1.0)));
    }
    for (Eigen::Index j = 0; j < n; ++j) announce(single * double(j), single * double(j + 1), int(j));
    announce(together, s.duration, all_joints);
  }
};

SKINCTL_END_NAMESPACE

// A cup between the fingertips of a hand, which feel it along three axes: a plant for tests of grasps.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <vector>

#include "skinctl/dynamics/forward_dynamics.hpp"
#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/robots/allegro.hpp"
#include "skinctl/tactile/patch.hpp"

namespace skinctl::testing {

/// Index, middle and thumb of an Allegro hand around a cup that hangs across their plane and does not tilt.
///
/// A contact is a spring along its normal, and bristles across as those of `RubbedBlock`. A controller of the
/// hand's own bears hand and cup: gravity compensation, weak springs of the joints, and at each fingertip a
/// stiff spring along the weight; it leaves the grip to the torque of `advance`.
class HeldCup {
 public:
  static constexpr std::size_t fingers = 3, cells = 4;  ///< number of fingertips, and of cells of each
  using Hand = std::remove_cvref_t<decltype(allegro::right_hand())>;
  using Known =
      Quantities<Hand, Needs{.jacobians = link_bit<3> | link_bit<7> | link_bit<15>, .gravity = true}>;
  /// Places of the fingertips in their links: 3, 7, 15 [m].
  static constexpr std::array<Xyz<double>, fingers> tips = {Xyz<double>{0.03, 0, 0}, Xyz<double>{0.03, 0, 0},
                                                            Xyz<double>{0.03, 0.01, 0}};
  /// A fingertip on the cup, along the axes of the base.
  struct Touch {
    Xyz<double> place, normal;   ///< point on the cup [m], unit normal into the cup
    Xyz<double> bend{0, 0, 0};   ///< deflection of the bristles [m]
    Xyz<double> slid{0, 0, 0};   ///< path of the fingertip on the cup [m]
    Xyz<double> force{0, 0, 0};  ///< force on the fingertip [N]
  };

  /// @param friction  coefficient of friction of the cup at rest; a slide has 0.8 of it.
  explicit HeldCup(double friction) : mu_(friction), hand_(allegro::right_hand()) {
    x_.q = {0.0, 0.6, 0.6, 0.4, 0.0, 0.6, 0.6, 0.4, 0.0, 0.2, 0.2, 0.2, 1.2, 0.4, 0.3, 0.4};
    first_ = x_;
    const auto at = places();
    const Xyz<double> middle = (1.0 / 3) * Xyz<double>(at[0] + at[1] + at[2]);
    for (std::size_t f = 0; f < fingers; ++f) {
      const Xyz<double> to = middle - at[f];
      touch_[f] = {at[f], (1 / norm(to)) * to};
    }
    down_ = cross(Xyz<double>(at[1] - at[0]), Xyz<double>(at[2] - at[0]));
    down_ = (1 / norm(down_)) * down_;
  }

  /// The cells of fingertip `f` on its link `L`: z looks into the cup, y hangs down.
  template <std::size_t L>
  [[nodiscard]] std::vector<PlacedCell<L>> skin(std::size_t f) const {
    const auto R = axes(f);
    std::vector<PlacedCell<L>> placed;
    for (std::size_t i = 0; i < cells; ++i)
      placed.push_back(
          {static_cast<std::uint32_t>(cells * f + i), {R, tips[f] + (i % 2 == 0 ? 0.002 : -0.002) * R.y}});
    return placed;
  }
  /// Axes of the cells of fingertip `f`, in its link.
  [[nodiscard]] Rotation<double> axes(std::size_t f) const {
    const auto R = at_link(first_, f).axes();
    const Xyz<double> z = turn_back(R, touch_[f].normal), y = turn_back(R, down_);
    return {cross(y, z), y, z};
  }
  /// The force on a cell of fingertip `f` along its axes, a pressure positive [N].
  [[nodiscard]] Xyz<double> felt(std::size_t f) const {
    const auto R = axes(f);
    const Xyz<double> F = (1.0 / cells) * turn_back(at_link(x_, f).axes(), touch_[f].force);
    return {dot(F, R.x), dot(F, R.y), -dot(F, R.z)};
  }

  /// Runs for `dt` [s] under the joint torques of a grip [N m].
  /// @param borne  share of the weight of the cup's `mass` [kg] that the hand bears.
  /// @param pull   force on the cup, downwards [N].
  void advance(double dt, const JointTorque<16>& grip, double mass, double borne, double pull) {
    const Known known(hand_, x_, dt, NoTouch{});
    const auto index = tip<3>(0);  // the Jacobians refer to them
    const auto middle = tip<7>(1);
    const auto thumb = tip<15>(2);
    const std::tuple J{known.jacobian<3>(index), known.jacobian<7>(middle), known.jacobian<15>(thumb)};
    auto at = places();
    auto motors = grip + known.gravity();
    const auto push = [](const auto& J_f, const Xyz<double>& force, JointTorque<16>& tau) {
      typename std::remove_cvref_t<decltype(J_f)>::Load load;
      load.force = force, load.moment = {0, 0, 0};
      tau += transpose(J_f) * load;
    };
    const auto each = [&J](const auto& f) {
      f(0, std::get<0>(J)), f(1, std::get<1>(J)), f(2, std::get<2>(J));
    };
    each([&](std::size_t f, const auto& J_f) {
      const double below = dot(Xyz<double>(at[f] - touch_[f].place), down_),
                   falls = dot((J_f * x_.dq).linear, down_);
      push(J_f, (-2000 * below - 5 * falls) * down_, motors);
    });
    constexpr int steps = 10;  // the contacts are stiff
    const double h = dt / steps;
    for (int step = 0; step < steps; ++step) {
      auto tau = motors;
      for (std::size_t i = 0; i < 16; ++i) tau[i] += 1.0 * (first_.q[i] - x_.q[i]) - 0.05 * x_.dq[i];
      Xyz<double> on_cup = (mass * 9.81 * borne + pull) * down_ - (borne < 1 ? 40 * mass : 0.0) * v_;
      each([&](std::size_t f, const auto& J_f) {
        rub(touch_[f], h, at[f] - p_, (J_f * x_.dq).linear - v_);
        push(J_f, touch_[f].force, tau);
        on_cup = on_cup - touch_[f].force;
      });
      x_.dq = integrate(x_.dq, forward_dynamics(hand_, x_.q, x_.dq, tau).acceleration, h);
      x_.q = integrate(x_.q, x_.dq, h);
      v_ = v_ + (h / mass) * on_cup, p_ = p_ + h * v_;
      each([&](std::size_t f, const auto& J_f) { at[f] = at[f] + h * (J_f * x_.dq).linear; });
    }
  }

  [[nodiscard]] const Hand& hand() const noexcept { return hand_; }
  [[nodiscard]] const State<16>& state() const noexcept { return x_; }
  [[nodiscard]] const Touch& touch(std::size_t f) const noexcept { return touch_[f]; }
  [[nodiscard]] const Xyz<double>& down() const noexcept { return down_; }
  /// Displacement of the cup since the start [m].
  [[nodiscard]] const Xyz<double>& moved() const noexcept { return p_; }
  /// Largest path that a fingertip has slid on the cup [m].
  [[nodiscard]] double slid() const {
    return std::max({norm(touch_[0].slid), norm(touch_[1].slid), norm(touch_[2].slid)});
  }
  /// The positions of the fingertips in the base [m].
  [[nodiscard]] std::array<Xyz<double>, fingers> places() const {
    const Poses<Hand, all_links(16)> poses(hand_, x_.q);
    return {(poses.template get<3>() * tip<3>(0)).origin(), (poses.template get<7>() * tip<7>(1)).origin(),
            (poses.template get<15>() * tip<15>(2)).origin()};
  }

 private:
  template <std::size_t L>
  static Transform<Link<L>, Tool> tip(std::size_t f) {
    return Transform<Link<L>, Tool>::translation_xyz(tips[f].x, tips[f].y, tips[f].z);
  }
  // The pose of a fingertip's link.
  Transform<Base, Tool> at_link(const State<16>& x, std::size_t f) const {
    const Poses<Hand, all_links(16)> poses(hand_, x.q);
    const auto as = [](const auto& X) { return Transform<Base, Tool>(X.axes(), X.origin()); };
    return f == 0   ? as(poses.template get<3>())
           : f == 1 ? as(poses.template get<7>())
                    : as(poses.template get<15>());
  }
  // Bristle::step along two axes.
  void rub(Touch& t, double h, const Xyz<double>& at, const Xyz<double>& v) const {
    const double f_n = std::max(0.0, 5000 * dot(Xyz<double>(at - t.place), t.normal) + 3 * dot(v, t.normal));
    const Xyz<double> across = v - dot(v, t.normal) * t.normal, before = t.bend;
    const double speed = norm(across), g = mu_ * (0.8 + 0.2 * std::exp(-speed * speed / 2.5e-5));
    const double a = dot(t.bend, across) < 0 ? 0 : std::clamp((500 * norm(t.bend) / g - 0.7) / 0.3, 0.0, 1.0);
    t.bend = (1 / (1 + h * a * 500 * speed / g)) * Xyz<double>(t.bend + h * across);
    const Xyz<double> rate = (1 / h) * Xyz<double>(t.bend - before);
    t.slid = t.slid + h * Xyz<double>(across - rate);
    t.force = -f_n * t.normal - f_n * Xyz<double>(500.0 * t.bend + 0.5 * rate);
  }

  double mu_;
  Hand hand_;
  State<16> x_, first_;
  std::array<Touch, fingers> touch_;
  Xyz<double> down_{0, 0, 1}, p_{0, 0, 0}, v_{0, 0, 0};
};

}  // namespace skinctl::testing

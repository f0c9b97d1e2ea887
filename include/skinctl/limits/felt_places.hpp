// SPDX-License-Identifier: BSD-3-Clause
// How fast the places of a robot may go that its skin covers, by how well they feel.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/kinematics/jacobian.hpp"
#include "skinctl/limits/limit.hpp"
#include "skinctl/tactile/cell_place.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The kind of `FeltPlaces`, for `Cycle::without`.
struct FeltPlacesLimit {};

/// Part for `Cycle::with`: a limit on the speed of places on the skin, by how well they feel. A push on the
/// middle of cell i is noticed from the force `F_s` on: by the cell, its neighbours, a wrist sensor or the
/// motors. A body of stiffness k that the place meets at the speed v along its outward normal is pressed,
/// until the robot has stopped, by
///
///     F_s + k v T + k v^2 / (2 a),
///
/// so that v may be as large as keeps that within `force`, and 0 where `F_s` is not below it. All joints are
/// slowed alike (`skin_slowed`), away from a blind place and sideways not at all. While a push is felt, blind
/// places may go as fast as those that notice the lightest: else it would be a rigid robot to the hand that
/// pushes. Each place is judged anew every `PlaceSpeed::turns` cycles; before it was, it feels nothing.
/// Nothing limits what presses a place that stands, or a plan that runs ahead of a slowed robot: let it wait
/// (`JointControlSettings::waits`).
///
///     scene.with(FeltPlaces<Skin::cells>{.places = skin.places(), .stiffness = 3e3, .newtons = 20})
///
/// @tparam Cells  greatest number of cells of the touch.
template <std::size_t Cells>
struct FeltPlaces {
  using Kind = FeltPlacesLimit;
  static constexpr std::size_t no_wrist = ~std::size_t(0);
  std::vector<CellPlace> places;  ///< places of the touch's cells, in their order
  double force = 65;     ///< greatest force on a body that a place meets [N]; 65: of ISO/TS 15066, for a face
  double stiffness = 0;  ///< k, stiffness of the body with the skin's cover [N/m]; 0: not declared
  /// Largest speed of a place with F_s = 0, where no stiffness is declared [m/s]; of others it goes with
  /// `force` less F_s. 0.25: the reduced speed of ISO 10218-1.
  double speed = 0.25;
  /// a, deceleration of a place along its normal [m/s^2]. 5: of 0.5 m from its joint, at 10 rad/s^2.
  double deceleration = 5;
  /// T, time from the push to the beginning of braking. 40 ms: three cycles at 125 Hz, and a skin's samples.
  Nanoseconds reaction_time = 40ms;
  double newtons = 0;            ///< force per unit of a cell's reading [N]; required, > 0
  std::vector<double> motors{};  ///< torque of each joint that its motor notices [N m]; empty: none
  std::size_t wrist = no_wrist;  ///< link behind a wrist sensor, which senses for all links that it carries
  double wrist_force = 5;  ///< least force that the wrist sensor notices [N]; 5: beyond drift, with a payload
};

/// `FeltPlaces` of a robot, as a limit of a scene.
template <RobotModel M, std::size_t Cells, Real T = double>
class PlaceSpeed {
 public:
  static constexpr std::size_t joints = M::joints;
  using Kind = FeltPlacesLimit;
  using Settings = FeltPlaces<Cells>;
  static constexpr Precedence precedence = Precedence::places;
  static constexpr Reason reason = Reason::skin_slowed;
  static constexpr bool reads_coverage = true;
  /// Cycles in which every place is judged once: what a cell feels changes within its `max_age`, 250 ms.
  static constexpr std::size_t turns = 8;
  /// Speed below which a place counts as still, as rounding and what moves sideways have [m/s].
  static constexpr double still = 1e-4;

  /// Trivially copyable; `Memory{}` has judged nothing, and feels nothing.
  struct Memory {
    std::array<float, Cells> speed{};  ///< largest speed of each place, by cells and wrist sensor [m/s]
    std::size_t next = 0;              ///< place that is judged next
    bool touched = false;              ///< a push is felt: the robot gives way
  };

  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD PlaceSpeed(const M& model, const Settings& s) : model_(model), s_(s) {
    require(!s.places.empty() && s.places.size() <= Cells, "FeltPlaces: places", double(s.places.size()),
            "1 to Cells, those of the touch");
    const auto within = [](double x, double least, double most, const char* name, const char* range) {
      require(x >= least && x <= most, name, x, range);
    };
    within(s.force, 1, 1e4, "FeltPlaces: force", "1 to 1e4 N");
    require(s.stiffness == 0 || (s.stiffness >= 1 && s.stiffness <= 1e8), "FeltPlaces: stiffness",
            s.stiffness, "1 to 1e8 N/m, or 0: not declared");
    within(s.speed, 1e-3, 10, "FeltPlaces: speed", "0.001 to 10 m/s");
    within(s.deceleration, 1e-2, 1e3, "FeltPlaces: deceleration", "0.01 to 1000 m/s^2");
    within(seconds<double>(s.reaction_time), 0, 1, "FeltPlaces: reaction_time", "0 to 1 s");
    within(s.newtons, 1e-6, 1e6, "FeltPlaces: newtons", "1e-6 to 1e6 N");
    within(s.wrist_force, 1e-3, 1e4, "FeltPlaces: wrist_force", "0.001 to 1e4 N");
    require(s.motors.empty() || s.motors.size() == joints, "FeltPlaces: motors", double(s.motors.size()),
            "none, or one for each joint");
    for (const double torque : s.motors) within(torque, 1e-6, 1e6, "FeltPlaces: motors", "1e-6 to 1e6 N m");
    require(s.wrist < joints || s.wrist == Settings::no_wrist, "FeltPlaces: wrist", double(s.wrist),
            "a link of the robot");
    const LinkMask behind = s.wrist == Settings::no_wrist ? LinkMask(0) : carried_by(s.wrist);
    for (const CellPlace& p : s.places) {
      require(p.link < joints, "FeltPlaces: link of a place", double(p.link), "a link of the robot");
      const auto n = p.normal, m = cross(p.place, n);
      rows_.push_back(
          {{T(n.x), T(n.y), T(n.z), T(m.x), T(m.y), T(m.z)}, p.link, ((behind >> p.link) & 1u) != 0});
    }
  }
  [[nodiscard]] const Settings& settings() const noexcept { return s_; }

  /// The largest speed along its normal of a place where a push is noticed from `noticed` newtons on [m/s].
  [[nodiscard]] double speed(double noticed) const noexcept {
    if (!(noticed < s_.force)) return 0;
    const double left = s_.force - noticed, time = seconds<double>(s_.reaction_time);
    if (!(s_.stiffness > 0)) return s_.speed * left / s_.force;
    const double braking = 2 * left / (s_.stiffness * s_.deceleration);
    return s_.deceleration * braking / (time + std::sqrt(time * time + braking));
  }
  /// The least force on the middle of cell `i` that its touch or the wrist sensor notices [N].
  template <class Seen>
  [[nodiscard]] double noticed(const Seen& seen, std::size_t i) const noexcept {
    const double by_cells = s_.newtons * seen.noticed(i);
    return rows_[i].behind_wrist && s_.wrist_force < by_cells ? s_.wrist_force : by_cells;
  }

  template <class Seen>
  SKINCTL_INLINE Status look(Memory& m, const Seen& seen, const T&) const noexcept {
    m.touched = seen.touched();
    const std::size_t size = rows_.size();
    for (std::size_t k = 0; k < (size + turns - 1) / turns; ++k) {
      m.speed[m.next] = static_cast<float>(speed(noticed(seen, m.next)));
      m.next = m.next + 1 < size ? m.next + 1 : 0;
    }
    return {};
  }

  /// The share in [0, 1] of `u` at which no place exceeds its largest speed.
  template <class Going, class Seen>
  [[nodiscard]] SKINCTL_NOINLINE SpeedShare<T> share(const Memory& m, const Going& going, const Seen&,
                                                     const JointVelocity<joints, T>& u) const noexcept {
    const Motion motion(model_, going.q, u);
    T scale(1);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const T along = motion.along(rows_[i]);
      if (!(along * scale > T(m.speed[i]))) continue;
      const T most = allowed(m, motion, i);
      if (along * scale > most) scale = most / along;
    }
    return {scale, scale < T(1) ? Status(reason) : Status()};
  }
  /// Whether a smooth motion may end at `v`: no place that kept its largest speed is carried beyond that. One
  /// that was too fast when its cell died is slowed smoothly.
  template <class Going>
  [[nodiscard]] SKINCTL_NOINLINE bool keeps(const Memory& m, const Going& going,
                                            const JointVelocity<joints, T>& v,
                                            const JointPosition<joints, T>&) const noexcept {
    const Motion motion(model_, going.q, v), before(model_, going.q, going.from);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const T along = motion.along(rows_[i]);
      if (!(along > T(m.speed[i]))) continue;
      const T most = allowed(m, motion, i);
      if (along > most && !(before.along(rows_[i]) > most)) return false;
    }
    return true;
  }

 private:
  struct Row {
    std::array<T, 6>
        normal;  ///< outward normal, and its moment about the link's origin, along the link's axes
    std::size_t link;
    bool behind_wrist;
  };
  /// The velocities of the links at their origins, along their own axes: by all joints, and by each joint at
  /// 1 rad/s.
  class Motion {
   public:
    SKINCTL_INLINE Motion(const M& model, const JointPosition<joints, T>& q,
                          const JointVelocity<joints, T>& u) noexcept {
      const Poses<M, all_links(joints), T> poses(model, q);
      [&]<std::size_t... Ix>(std::index_sequence<Ix...>)
          SKINCTL_INLINE_LAMBDA { (put<Ix>(poses, u), ...); }(std::make_index_sequence<joints>{});
    }
    [[nodiscard]] SKINCTL_INLINE T along(const Row& row) const noexcept {
      return product(velocity_[row.link], row);
    }
    /// The lever arm of joint `j` for a force along the normal of a place: N m per N.
    [[nodiscard]] T lever(const Row& row, std::size_t j) const noexcept {
      return product(column_[row.link][j], row);
    }

   private:
    using Six = std::array<T, 6>;
    static SKINCTL_INLINE T product(const Six& v, const Row& row) noexcept {
      T sum = v[0] * row.normal[0];
      for (std::size_t k = 1; k < 6; ++k) sum = sum + v[k] * row.normal[k];
      return sum;
    }
    template <std::size_t Ix, class P>
    SKINCTL_INLINE void put(const P& poses, const JointVelocity<joints, T>& u) noexcept {
      const auto axes = poses.template get<Ix>().axes();
      jacobian<Ix>(poses).for_each([&](auto j, const auto& c) SKINCTL_INLINE_LAMBDA {
        const Six own = {dot(axes.x, c.linear),  dot(axes.y, c.linear),  dot(axes.z, c.linear),
                         dot(axes.x, c.angular), dot(axes.y, c.angular), dot(axes.z, c.angular)};
        column_[Ix][j.value] = own;
        for (std::size_t k = 0; k < 6; ++k) velocity_[Ix][k] = velocity_[Ix][k] + u[j.value] * own[k];
      });
    }
    std::array<Six, joints> velocity_{};
    std::array<std::array<Six, joints>, joints> column_{};
  };
  /// The largest speed of place `i` along its normal [m/s].
  [[nodiscard]] T allowed(const Memory& m, const Motion& motion, std::size_t i) const noexcept {
    T most(m.speed[i]);
    if (!s_.motors.empty())
      if (const T by_motors(speed(noticed_by_motors(motion, rows_[i]))); by_motors > most) most = by_motors;
    const T least = m.touched ? T(speed(0)) : T(still);
    return most > least ? most : least;
  }
  [[nodiscard]] double noticed_by_motors(const Motion& motion, const Row& row) const noexcept {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t j = 0; j < joints; ++j) {
      const double lever = std::abs(static_cast<double>(motion.lever(row, j)));
      if (lever * least > s_.motors[j]) least = s_.motors[j] / lever;
    }
    return least;
  }
  /// The mask of a link and of the links that it carries.
  [[nodiscard]] static LinkMask carried_by(std::size_t link) noexcept {
    return [&]<std::size_t... K>(std::index_sequence<K...>) {
      return ((K == link ? subtree<M>(K) : LinkMask(0)) | ...);
    }(std::make_index_sequence<joints>{});
  }

  [[no_unique_address]] M model_;
  Settings s_;
  std::vector<Row> rows_;
};

/// The `PlaceSpeed` limit that `felt` makes of a robot.
template <RobotModel M, std::size_t N, Real T, std::size_t Cells>
[[nodiscard]] auto part_for(const M& model, const JointLimits<N, T>&, const FeltPlaces<Cells>& felt) {
  return PlaceSpeed<M, Cells, T>(model, felt);
}

SKINCTL_END_NAMESPACE

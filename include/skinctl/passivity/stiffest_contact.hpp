// SPDX-License-Identifier: BSD-3-Clause
// The stiffest contact that a scene may meet: a part of a robot's description, checked where a scene is
// built.
#pragma once

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "skinctl/passivity/contact_stability.hpp"
#include "skinctl/tactile/contact.hpp"
#include "skinctl/tactile/touch.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A part of a description by position or velocity: `Cycle` refuses the scene with the number unless such
/// contacts come to rest, anywhere on the robot, one and two at a time. A description may have several.
///
/// The loops of `ContactStability` are computed at `poses` poses over the range of the joints, for cells all
/// over the skin (six of each patch, along their normals, with their gains), for pushes on the tool of a
/// wrist sensor, and where motors feel, or nothing says where touch is felt, for points all over each link;
/// for two contacts at once, as of two hands that grip, by the eigenvalues of both loops, for the eight
/// contacts of a pose that bear least. Some ten milliseconds, by Eigen: include `<Eigen/Eigenvalues>` to use
/// it.
///
/// What a robot with a delay lacks is felt mass: as heavy as what touches it, it answers in time. The refusal
/// says by which factor the virtual robot has to be heavier; force gains, virtual damping and viscous
/// friction divided by it give that mass, and the friction that is felt stays. A heavy robot with little
/// friction is at rest on a wall, but bounces on it for long: there a force lead of twice the total delay
/// damps. A factor of hundreds is that of a light joint, such as a flange that turns: it needs virtual
/// inertia of its own.
struct StiffestContact {
  using RobotPart = detail::StiffestContactPart;
  static constexpr bool of_virtual_robot = true;
  static constexpr bool repeats = true;  ///< a robot may declare several
  double stiffness = 0;                  ///< stiffness of the environment [N/m], > 0
  double cover = 0;                      ///< stiffness of the skin's cover, in series [N/m]; 0: rigid
  double body = 0;  ///< mass behind the contact [kg], as of a hand that holds it; 0: a wall
  /// Loss factor of the cover and of what it touches, the tangent of the loss angle, 0 to 1: rubber and foam
  /// 0.1, tissue more. Default: 0.1 before a body, 0 before a wall.
  std::optional<double> loss = {};
  double newtons = 0;        ///< newtons at a cell per unit of its readings; 0: the law gets the force itself
  Nanoseconds skin_delay{};  ///< age of a push when a cycle uses it, >= 0
  /// Required gain margin of one contact, >= 1. Default: 2 before a wall; 1 before a body, where the loop
  /// errs on the safe side.
  std::optional<double> margin = {};
  /// Required gain margin of two contacts at once, >= 1. Default: 1.5 before walls, 1 before bodies.
  std::optional<double> margin_of_two = {};
  /// Number of poses, 1 to 10 000: two at quarter turns and six between take some ten milliseconds.
  int poses = 8;

  /// The factor by which the virtual robot has to be felt heavier, so that all contacts have the required
  /// margins; less than 1 where it may be lighter. At least 1/64.
  template <DescribedRobot R, class Skin>
  [[nodiscard]] SKINCTL_COLD double heavier(const R& robot, const Skin& skin) const {
    const auto all = contacts(robot, skin);
    double low = min_mass, high = low;
    while (worst(all, high).lack > 1 && high < max_mass) low = high, high = 2 * high;
    for (int n = 0; n < halvings && high > low; ++n) {
      const double middle = std::sqrt(low * high);
      (worst(all, middle).lack > 1 ? low : high) = middle;
    }
    return high;
  }

  /// The least felt mass of all contacts [kg]: of the virtual robot along a contact, over the newtons that a
  /// law gets for one.
  template <DescribedRobot R, class Skin>
  [[nodiscard]] SKINCTL_COLD double min_felt_mass(const R& robot, const Skin& skin) const {
    double mobility = 0;
    for (const auto& pose : contacts(robot, skin).poses)
      for (std::size_t i = 0; i < pose.rows.size(); ++i) {
        double sum = 0;
        for (const double r : pose.rows[i]) sum += pose.gains[i] * r * r;
        mobility = std::max(mobility, sum);
      }
    return mobility > 0 ? 1 / mobility : std::numeric_limits<double>::infinity();
  }

  /// The text of a refusal, with the factor by which felt mass is lacking; empty if all contacts rest.
  template <DescribedRobot R, class Skin>
  [[nodiscard]] SKINCTL_COLD std::string warning(const R& robot, const Skin& skin) const {
    static_assert(R::interface != Interface::torque,
                  "StiffestContact: by torque there is no virtual robot behind a delay; leave it out");
    if (worst(contacts(robot, skin), 1).lack <= 1) return {};
    char text[384];
    std::snprintf(text, sizeof text,
                  "skinctl: felt mass beside that of a %s = 1, allowed: >= %.3g for a contact of %.4g N/m: "
                  "divide force gains, "
                  "virtual damping and friction by it, add virtual inertia, or shorten the delay",
                  body > 0 ? "body" : "wall", heavier(robot, skin), series());
    return text;
  }

  /// Throws `ConfigurationError` with the felt mass needed unless all contacts rest.
  template <DescribedRobot R, class Skin>
  SKINCTL_COLD void check(const R& robot, const Skin& skin) const {
    if (const std::string lacking = warning(robot, skin); !lacking.empty()) refuse(lacking);
  }

 private:
  static constexpr double min_mass = 1.0 / 64;  ///< lightest mass of the search, over the felt one
  static constexpr double max_mass = 1e6;       ///< heaviest mass of the search, over the felt one
  static constexpr int halvings = 10;           ///< steps of the search for a mass: known to 0.1 %

  /// The contacts at one pose.
  template <std::size_t N>
  struct Pose {
    detail::ContactModes<N, double> robot;
    std::vector<std::array<double, N>> rows;  ///< rows of the contacts in modes
    std::vector<double> gains;                ///< force gains of the contacts
  };
  template <std::size_t N>
  struct AllContacts {
    detail::ContactPath<double> path;
    std::vector<Pose<N>> poses;
  };
  /// The contacts furthest from their margin; `lack` > 1 if it is missed.
  struct Worst {
    double lack = 0;
    std::size_t pose = 0, one = 0, two = 0;  ///< index of the pose, and of its contacts; equal: a single one
  };

  template <class T>
  [[nodiscard]] ContactEnvironment<T> environment() const noexcept {
    return {.stiffness = T(stiffness), .cover = T(cover), .body = T(body), .skin_delay = skin_delay};
  }
  [[nodiscard]] double series() const noexcept { return environment<double>().series(); }
  static constexpr double usual_margin = 2;           ///< default of `margin` before a wall: 6 dB
  static constexpr double usual_margin_of_two = 1.5;  ///< default of `margin_of_two` before walls
  static constexpr double usual_loss = 0.1;           ///< loss factor of rubber and foam, that of a cover
  static constexpr std::size_t cells_of_patch = 6;    ///< contacts looked at on each patch
  static constexpr double end_of_link = 1;            ///< distance of contacts at link's ends, over its reach
  static constexpr double on_link = 0.3;              ///< distance of contacts on a link, over its reach
  /// Every fourth pose has its joints at quarter turns, where normals meet axes.
  static constexpr int quarter_turns_every = 4;
  /// Contacts of a pose that are looked at in pairs, which bear least.
  static constexpr std::size_t pairs = 8;

  [[nodiscard]] double margin_of_one_contact() const noexcept {
    return margin.value_or(body > 0 ? 1 : usual_margin);
  }
  [[nodiscard]] double margin_of_two_contacts() const noexcept {
    return margin_of_two.value_or(body > 0 ? 1 : usual_margin_of_two);
  }
  void check_numbers() const {
    require(poses >= 1 && poses <= 10000, "StiffestContact: poses", poses, "1 to 10 000");
    require(!loss || (*loss >= 0 && *loss <= 1), "StiffestContact: loss", loss.value_or(0), "0 to 1");
    require(newtons >= 0 && newtons <= 1e6, "StiffestContact: newtons", newtons, "0 to 1e6 N");
    require(margin_of_one_contact() >= 1 && margin_of_one_contact() <= 100, "StiffestContact: margin",
            margin_of_one_contact(), "1 to 100");
    require(margin_of_two_contacts() >= 1 && margin_of_two_contacts() <= 100,
            "StiffestContact: margin of two", margin_of_two_contacts(), "1 to 100");
  }

  template <DescribedRobot R, class Skin>
  [[nodiscard]] auto contacts(const R& robot, const Skin& skin) const {
    using T = typename R::scalar;
    using M = typename R::model_type;
    constexpr std::size_t N = M::joints;
    check_numbers();
    const auto& c = robot.configuration();
    const auto tool = tool_in(robot.parts());
    const ContactStability<M, T, std::remove_cv_t<decltype(tool)>> stability(robot.model(), c,
                                                                             environment<T>(), tool);
    AllContacts<N> out{{c, skin_delay}, {}};
    for (int k = 0; k < poses; ++k) {
      JointPosition<N, T> q;
      for (std::size_t i = 0; i < N; ++i) {
        const double lower = std::max(-std::numbers::pi, static_cast<double>(c.limits.lower()[i]));
        const double upper = std::min(std::numbers::pi, static_cast<double>(c.limits.upper()[i]));
        // The poses that are not at quarter turns are spread evenly over the range.
        const double even = lower + (upper - lower) * halton(unsigned(k) + 1, i);
        constexpr double quarter = 0.5 * std::numbers::pi;
        q[i] = T(k % quarter_turns_every == 0 ? quarter * std::round(even / quarter) : even);
      }
      const auto felt = stability.felt(q);
      MassMatrix<N, double> inertia, friction;
      for (std::size_t i = 0; i < N; ++i)
        for (std::size_t j = 0; j < N; ++j) {
          inertia(i, j) = static_cast<double>(felt.inertia(i, j));
          friction(i, j) = static_cast<double>(felt.friction(i, j));
        }
      Pose<N> pose{detail::ContactModes<N, double>(inertia, friction), {}, {}};
      each_contact(robot.model(), q, skin, [&](const JointTorque<N, T>& tau, double gain) {
        double row[N], size = 0;
        for (std::size_t i = 0; i < N; ++i) row[i] = -static_cast<double>(tau[i]), size += row[i] * row[i];
        if (!(size > 0) || !(gain > 0)) return;
        auto& mode = pose.rows.emplace_back();
        pose.robot.row(row, mode.data());
        pose.gains.push_back(gain);
      });
      out.poses.push_back(std::move(pose));
    }
    return out;
  }

  /// Calls `f(tau, w_f)` for contacts all over the robot: tau the joint torque of one newton, w_f the gain.
  template <class M, std::size_t N, class T, class Skin, class F>
  void each_contact(const M& model, const JointPosition<N, T>& q, const Skin& skin, F&& f) const {
    constexpr LinkMask all = all_links(N);
    const JointAngles<M, T, all> angles(model, q);
    const auto touch = [&](std::size_t link, const Xyz<T>& force, const Xyz<T>& moment, double gain) {
      LinkWrenches<M, all, T> one;
      T* w = one.data[link];
      w[0] = force.x, w[1] = force.y, w[2] = force.z, w[3] = moment.x, w[4] = moment.y, w[5] = moment.z;
      f(skin_torque(model, angles, one), gain);
    };
    using Table = TouchTable<Skin>;
    if constexpr (Table::has_cell_list)
      skin.each_cell([&](std::size_t link, const Xyz<T>& force, const Xyz<T>& moment,
                         double gain) { touch(link, force, moment, newtons > 0 ? gain / newtons : 1); },
                     cells_of_patch);
    Table::each_point(skin, touch);
    if constexpr (Table::feels_everywhere || !(Table::has_cell_list || Table::has_points)) {
      const double gain = Table::feels_everywhere ? Table::gain_everywhere(skin) : 1;
      const auto reach = detail::assumed_reach<M, T>(model);
      const Xyz<T> axes[3] = {{T(1), T(0), T(0)}, {T(0), T(1), T(0)}, {T(0), T(0), T(1)}};
      for (std::size_t link = 0; link < N; ++link)
        for (int along = 0; along < 3; ++along)
          for (int side = 1; side < 3; ++side)
            for (const double far : {-end_of_link, -on_link, on_link, end_of_link}) {
              const Xyz<T> p = T(far) * reach[link] * axes[along], n = axes[(along + side) % 3];
              touch(link, n, cross(p, n), gain);
            }
    }
  }
  template <class... Parts>
  [[nodiscard]] static auto tool_in(const std::tuple<Parts...>& parts) {
    constexpr std::size_t at = [] {
      std::size_t i = 0, found = sizeof...(Parts);
      ((std::is_same_v<typename Parts::RobotPart, detail::ToolShapePart> ? found = i : found, ++i), ...);
      return found;
    }();
    if constexpr (at < sizeof...(Parts)) {
      return std::get<at>(parts);
    } else {
      return NoToolShape{};
    }
  }
  /// The `n`-th number of the Halton sequence of the `i`-th prime, 0 to 1; from the 17th joint on of the same
  /// primes, seven numbers later.
  [[nodiscard]] static double halton(unsigned n, std::size_t i) {
    constexpr unsigned primes[16] = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53};
    const unsigned base = primes[i % 16];
    double x = 0, part = 1;
    for (n += static_cast<unsigned>(i / 16) * 7; n > 0; n /= base) part /= base, x += part * (n % base);
    return x;
  }

  /// The factor by which the contacts `one` and `two` of a pose (equal: a single one) are too stiff to keep
  /// their margin, for a virtual robot that is felt `factor` times heavier: above 1 they miss it.
  template <std::size_t N>
  [[nodiscard]] double lack(const AllContacts<N>& all, std::size_t pose, std::size_t one, std::size_t two,
                            double factor) const {
    const auto& p = all.poses[pose];
    const bool alone = one == two;
    const detail::ContactLoops<N, double> loops{.robot = p.robot,
                                                .path = all.path,
                                                .a = p.rows[one].data(),
                                                .gain_a = p.gains[one],
                                                .b = alone ? nullptr : p.rows[two].data(),
                                                .gain_b = p.gains[two],
                                                .heavier = factor};
    return lack_of(loops, series(), body, loss.value_or(body > 0 ? usual_loss : 0.0),
                   alone ? margin_of_one_contact() : margin_of_two_contacts());
  }
  template <std::size_t N>
  [[nodiscard]] Worst worst(const AllContacts<N>& all, double factor) const {
    Worst out;
    const auto look = [&](std::size_t pose, std::size_t one, std::size_t two) {
      const double l = lack(all, pose, one, two, factor);
      if (l > out.lack) out = {l, pose, one, two};
      return l;
    };
    for (std::size_t pose = 0; pose < all.poses.size(); ++pose) {
      const std::size_t n = all.poses[pose].rows.size();
      std::vector<std::pair<double, std::size_t>> order;
      for (std::size_t i = 0; i < n; ++i) order.push_back({-look(pose, i, i), i});
      const std::size_t most = std::min(pairs, n);
      std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(most), order.end());
      for (std::size_t i = 0; i < most; ++i)
        for (std::size_t j = i + 1; j < most; ++j) look(pose, order[i].second, order[j].second);
    }
    return out;
  }
};

/// Two hands of 5 kg under 10 kN/m: for a scene that declares no contact, as a warning.
inline constexpr StiffestContact usual_hands{.stiffness = 1e4, .body = 5};

SKINCTL_END_NAMESPACE

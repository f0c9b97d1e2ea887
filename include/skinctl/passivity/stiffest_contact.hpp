// The stiffest contact that a scene may meet: a part of a robot's description, checked where a scene is built.
#pragma once

#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>

#include "skinctl/passivity/contact_damper.hpp"
#include "skinctl/passivity/contact_stability.hpp"
#include "skinctl/passivity/detail/contact_modes.hpp"
#include "skinctl/tactile/touch.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A part of a description by position or velocity: `Cycle` refuses the scene with the number unless such
/// contacts come to rest, anywhere on the robot, one and two at a time.
///
/// The loops of `ContactStability` are computed at `poses` poses over the range of the joints, for cells all
/// over the skin (six of each patch, along their normals, with their gains), for pushes on the tool of a wrist
/// sensor, and where motors feel, or nothing says where touch is felt, for points all over each link; for two contacts at once by the eigenvalues of both loops, for the
/// eight contacts of a pose that bear least. One contact needs the gain margin `margin`, two `margin_of_two`:
/// poses and contacts between those that are looked at take a few per cent of it. Some ten milliseconds, by Eigen:
/// include `<Eigen/Eigenvalues>` to use it.
///
/// Damping that is needed comes from a `ContactDamper` in the same description: `damper` makes one that fits.
/// Damping that is always on is felt by a hand as well: with 850 N s/m, 20 N lead an arm at 20 mm/s. With
/// `may_ring` it is added when a contact has rung.
struct StiffestContact {
  using RobotPart = detail::StiffestContactPart;
  double stiffness = 0;      ///< of the environment [N/m], > 0
  double cover = 0;          ///< of the skin's cover, in series [N/m]; 0: rigid
  double newtons = 0;        ///< newtons at a cell per unit of its force readings; 0: the law takes what acts
  Nanoseconds skin_delay{};  ///< age of a push when a cycle uses it, >= 0
  double margin = 2;         ///< required gain margin of one contact, >= 1
  double margin_of_two = 1.5;  ///< of two at once, >= 1
  /// Whether a contact may ring first: then what the damper adds by observation counts too.
  bool may_ring = false;
  int poses = 8;  ///< 1 to 10 000

  /// The damping along contacts with which they all have the required margins [N s/m]; 0 if they need none.
  template <DescribedRobot R, class Skin>
  [[nodiscard]] SKINCTL_COLD double damping(const R& robot, const Skin& skin) const {
    return min_damping(contacts(robot, skin), robot);
  }
  /// A damper of that damping, always on: for the description of the same robot.
  template <DescribedRobot R, class Skin>
  [[nodiscard]] SKINCTL_COLD auto damper(const R& robot, const Skin& skin) const {
    using T = typename R::scalar;
    return ContactDamper<T>({.always = T(damping(robot, skin))});
  }

  /// Throws `ConfigurationError` with the damping in force and the one needed unless all contacts rest.
  template <DescribedRobot R, class Skin>
  SKINCTL_COLD void check(const R& robot, const Skin& skin) const {
    static_assert(R::interface != Interface::torque,
                  "StiffestContact: by torque there is no virtual robot behind a delay; leave it out");
    using T = typename R::scalar;
    double given = 0;
    if constexpr (R::template has<ContactDamper<T>>) {
      const auto& s = std::get<ContactDamper<T>>(robot.parts()).settings();
      given = static_cast<double>(may_ring ? T(s.always + s.max) : s.always);
    }
    const auto all = contacts(robot, skin);
    if (worst(all, robot, given).lack <= 1) return;
    char text[96];
    std::snprintf(text, sizeof text, ">= %.4g N s/m for a contact of %.4g N/m: see StiffestContact::damper",
                  min_damping(all, robot), series());
    require(false, may_ring ? "contact damping, always and by observation" : "contact damping, always", given,
            text);
  }

 private:
  /// The contacts at one pose.
  template <std::size_t N>
  struct Pose {
    detail::ContactModes<N, double> robot;
    std::vector<std::array<double, N>> rows;  ///< in modes
    std::vector<double> gains;
  };
  template <std::size_t N>
  struct AllContacts {
    detail::ContactPath<double> path;
    std::vector<Pose<N>> poses;
  };
  /// The contacts furthest from their margin: `lack` > 1 if it is missed.
  struct Worst {
    double lack = 0;
    std::size_t pose = 0, one = 0, two = 0;
  };

  [[nodiscard]] double series() const noexcept {
    return cover > 0 ? stiffness * cover / (stiffness + cover) : stiffness;
  }
  void check_numbers() const {
    require(poses >= 1 && poses <= 10000, "StiffestContact: poses", poses, "1 to 10 000");
    require(newtons >= 0 && newtons <= 1e6, "StiffestContact: newtons", newtons, "0 to 1e6 N");
    require(margin_of_two >= 1 && margin_of_two <= 100, "StiffestContact: margin of two", margin_of_two,
            "1 to 100");
  }

  template <DescribedRobot R, class Skin>
  [[nodiscard]] auto contacts(const R& robot, const Skin& skin) const {
    using T = typename R::scalar;
    using M = typename R::model_type;
    constexpr std::size_t N = M::joints;
    check_numbers();
    const auto& c = robot.configuration();
    const auto tool = tool_in(robot.parts());
    const ContactStability<M, T, std::remove_cv_t<decltype(tool)>> stability(
        robot.model(), c,
        {.stiffness = T(stiffness), .cover = T(cover), .skin_delay = skin_delay, .margin = T(margin)}, tool);
    AllContacts<N> out{{c.delay, skin_delay, c.period, c.lag, c.lead}, {}};
    for (int k = 0; k < poses; ++k) {
      JointPosition<N, T> q;
      for (std::size_t i = 0; i < N; ++i) {
        const double lower = std::max(-M_PI, static_cast<double>(c.limits.lower()[i]));
        const double upper = std::min(M_PI, static_cast<double>(c.limits.upper()[i]));
        // Every fourth pose at quarter turns, where normals meet axes; the others evenly over the range.
        const double even = lower + (upper - lower) * halton(unsigned(k) + 1, i);
        q[i] = T(k % 4 == 0 ? 0.5 * M_PI * std::round(even / (0.5 * M_PI)) : even);
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
        if (!(size > 1e-12) || !(gain > 0)) return;
        auto& mode = pose.rows.emplace_back();
        pose.robot.row(row, mode.data());
        pose.gains.push_back(gain);
      });
      out.poses.push_back(std::move(pose));
    }
    return out;
  }

  /// Calls `f(tau, w_f)` for contacts all over the robot, tau the torque of one newton.
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
                     6);
    Table::each_point(skin, touch);
    if constexpr (Table::feels_everywhere || !(Table::has_cell_list || Table::has_points)) {
      const double gain = Table::feels_everywhere ? Table::gain_everywhere(skin) : 1;
      const auto reach = detail::assumed_reach<M, T>(model);
      const Xyz<T> axes[3] = {{T(1), T(0), T(0)}, {T(0), T(1), T(0)}, {T(0), T(0), T(1)}};
      for (std::size_t link = 0; link < N; ++link)
        for (int along = 0; along < 3; ++along)
          for (int side = 1; side < 3; ++side)
            for (const double far : {-1.0, -0.3, 0.3, 1.0}) {
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
  /// Of the `i`-th prime, 0 to 1.
  [[nodiscard]] static double halton(unsigned n, std::size_t i) {
    constexpr unsigned primes[16] = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53};
    const unsigned base = primes[i % 16];
    double x = 0, part = 1;
    for (n += static_cast<unsigned>(i / 16) * 7; n > 0; n /= base) part /= base, x += part * (n % base);
    return x;
  }

  /// How much stiffness contacts lack, at damping `b`.
  template <std::size_t N>
  [[nodiscard]] double lack(const AllContacts<N>& all, std::size_t pose, std::size_t one, std::size_t two,
                            double b) const {
    const auto& p = all.poses[pose];
    const bool alone = one == two;
    const double k = detail::stiffest_contacts(p.robot, all.path, p.rows[one].data(), p.gains[one],
                                               alone ? nullptr : p.rows[two].data(), p.gains[two], b);
    return (alone ? margin : margin_of_two) * series() / k;
  }
  template <class R, std::size_t N>
  [[nodiscard]] Worst worst(const AllContacts<N>& all, const R&, double b) const {
    Worst out;
    const auto look = [&](std::size_t pose, std::size_t one, std::size_t two) {
      const double l = lack(all, pose, one, two, b);
      if (l > out.lack) out = {l, pose, one, two};
      return l;
    };
    for (std::size_t pose = 0; pose < all.poses.size(); ++pose) {
      const std::size_t n = all.poses[pose].rows.size();
      std::vector<std::pair<double, std::size_t>> order;
      for (std::size_t i = 0; i < n; ++i) order.push_back({-look(pose, i, i), i});
      const std::size_t most = std::min<std::size_t>(8, n);
      std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(most), order.end());
      for (std::size_t i = 0; i < most; ++i)
        for (std::size_t j = i + 1; j < most; ++j) look(pose, order[i].second, order[j].second);
    }
    return out;
  }
  template <class R, std::size_t N>
  [[nodiscard]] double min_damping(const AllContacts<N>& all, const R& robot) const {
    double b = 0;
    // The worst contacts get what they need, until none is left; a little more, so that few rounds do.
    for (int round = 0; round < 30; ++round) {
      const Worst w = worst(all, robot, b);
      if (w.lack <= 1) return b;
      double low = b, high = b > 0 ? 2 * b : 1;
      while (lack(all, w.pose, w.one, w.two, high) > 1 && high < 1e9) low = high, high = 2 * high;
      for (int n = 0; n < 12; ++n) {
        const double middle = 0.5 * (low + high);
        (lack(all, w.pose, w.one, w.two, middle) > 1 ? low : high) = middle;
      }
      b = 1.005 * high;
    }
    return b;
  }
};

SKINCTL_END_NAMESPACE

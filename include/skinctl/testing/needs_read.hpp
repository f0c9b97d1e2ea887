// SPDX-License-Identifier: BSD-3-Clause
// Which of the quantities that a law asks for it reads: what it asks for and nobody reads costs time in every
// cycle.
#pragma once

#include <string>
#include <type_traits>
#include <utility>

#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/law/evaluate.hpp"
#include "skinctl/tactile/link_wrenches.hpp"
#include "skinctl/testing/random.hpp"

namespace skinctl::testing {

/// `Quantities` that note in `read` what a law takes from them. `poses()` counts as all of the links.
template <RobotModel M, Needs Asked, Scalar T, class Touch>
class NotingQuantities : public Quantities<M, Asked, T, Touch> {
  using Of = Quantities<M, Asked, T, Touch>;

 public:
  NotingQuantities(const M& model, const State<M::joints, T>& state, const T& dt, const Touch& touch,
                   Needs& read) noexcept
      : Of(model, state, dt, touch), read_(read) {}

  [[nodiscard]] decltype(auto) touch() const noexcept { return read_.touch = true, Of::touch(); }
  [[nodiscard]] decltype(auto) angles() const noexcept { return read_.angles = true, Of::angles(); }
  [[nodiscard]] decltype(auto) middle() const noexcept { return read_.middle = true, Of::middle(); }
  [[nodiscard]] decltype(auto) poses() const noexcept { return read_.poses |= Of::needs.poses, Of::poses(); }
  template <std::size_t Ix>
  [[nodiscard]] auto pose() const noexcept {
    return read_.poses |= link_bit<Ix>, Of::template pose<Ix>();
  }
  template <std::size_t Ix, class... X>
  [[nodiscard]] auto jacobian(const X&... X_LP) const noexcept {
    return read_.jacobians |= link_bit<Ix>, Of::template jacobian<Ix>(X_LP...);
  }
  [[nodiscard]] decltype(auto) gravity() const noexcept { return read_.gravity = true, Of::gravity(); }
  [[nodiscard]] decltype(auto) mass() const noexcept { return read_.mass = true, Of::mass(); }
  [[nodiscard]] decltype(auto) mass_factors() const noexcept {
    return read_.mass_factors = true, Of::mass_factors();
  }
  [[nodiscard]] decltype(auto) coriolis() const noexcept { return read_.coriolis = true, Of::coriolis(); }

 private:
  Needs& read_;
};

/// The quantities in words, links from 1 as a robot's maker counts them; "-" for none.
[[nodiscard]] inline std::string in_words(const Needs& n) {
  std::string out;
  const auto links = [&](const char* what, LinkMask mask) {
    if (mask == 0) return;
    out += std::string(what) + " of";
    for (int i = 0; i < 64; ++i)
      if ((mask >> i & 1u) != 0) out += " " + std::to_string(i + 1);
    out += ", ";
  };
  links("poses", n.poses), links("Jacobians", n.jacobians);
  const std::pair<bool, const char*> flags[] = {{n.angles, "angles"},
                                                {n.gravity, "G"},
                                                {n.mass, "M"},
                                                {n.mass_factors, "factors of M"},
                                                {n.coriolis, "C dq"},
                                                {n.touch, "touch"},
                                                {n.middle, "angles half a step ahead"}};
  for (const auto& [wanted, name] : flags)
    if (wanted) out += std::string(name) + ", ";
  return out.empty() ? "-" : out.substr(0, out.size() - 2);
}

/// The members of `asked` that are not in `read`. A pose is read with the Jacobian of its link, M with
/// its factors, and any of them with the angles.
[[nodiscard]] constexpr Needs unread(const Needs& asked, const Needs& read) noexcept {
  const bool by_angles = read.angles || read.any_mass() || read.poses != 0 || read.jacobians != 0;
  return {.poses = asked.poses & ~(read.poses | read.jacobians),
          .jacobians = asked.jacobians & ~read.jacobians,
          .angles = asked.angles && !by_angles,
          .gravity = asked.gravity && !read.gravity,
          .mass = asked.mass && !read.mass && !read.mass_factors,
          .mass_factors = asked.mass_factors && !read.mass_factors,
          .coriolis = asked.coriolis && !read.coriolis,
          .touch = asked.touch && !read.touch,
          .middle = asked.middle && !read.middle};
}

/// The quantities that `law` reads of those it asks for, while it runs so many cycles from each of so many
/// random states of a robot that is touched on all links, goes to `goal`s (if the law takes them and some are
/// given), and is opposed now and then. A tracking law asks for G only where it is alone: the scene that adds
/// it reads it.
template <RobotModel M, class L, class... Goal>
[[nodiscard]] Needs needs_read(const M& model, const L& law, int states, int cycles, const Goal&... goal) {
  constexpr LinkMask all = (LinkMask(2) << (M::joints - 1)) - 1;
  using Touch = LinkWrenches<M, all, double>;
  using K = NotingQuantities<M, L::needs, double, Touch>;
  Needs noted;
  noted.gravity = L::role == LawRole::tracking;
  Seeded rng(17);
  const double dt = 0.002;
  for (int s = 0; s < states; ++s) {
    State<M::joints> x{1ms, rng.template vector<JointPosition<M::joints>>(1), {}};
    Touch touch;
    const auto known = [&] { return K(model, x, dt, touch, noted); };
    auto memory = law.start(known());
    [[maybe_unused]] const auto receive = [&](const auto& g) {
      memory = follow_or_receive(law, memory, known(), g).memory;
    };
    for (int c = 0; c < cycles; ++c) {
      if (c == 1) (receive(goal), ...);
      if (c == cycles / 2)
        for (auto& wrench : touch.data)
          for (double& v : wrench) v = 20 * rng();
      x.time += 2ms;
      x.dq = rng.template vector<JointVelocity<M::joints>>(1);
      x.q = integrate(x.q, x.dq, dt);
      memory = evaluate(law, memory, known(), dt).memory;
      static_cast<void>(torque_of(law, memory, known()));
      static_cast<void>(settled(law, memory, known(), 0.01));
      for (const Opposition o : {Opposition::lasting, Opposition::released})
        static_cast<void>(law.advance(memory, known(), dt, o));
    }
  }
  return noted;
}

}  // namespace skinctl::testing

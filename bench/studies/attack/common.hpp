// What the attacks share: a UR5 with six cells, pushes on them, swings at rest, and the table of what was
// found.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string_view>
#include <vector>

#include "skinctl/skinctl.hpp"
#include "tests/support/touched_arm.hpp"

namespace attacks {

/// The worst of something over all scenes.
struct Found {
  const char* what;
  double bound;        ///< up to which a scene is fine
  bool judged = true;  ///< whether a scene beyond it fails the attack
  double worst = 0;
  std::uint64_t seed = 0, scenes = 0;  ///< of the worst; beyond the bound

  void take(double value, std::uint64_t of) {
    if (!(value <= bound)) ++scenes;
    if (!(value <= worst)) worst = value, seed = of;
  }
};
/// Prints the table; false: a scene is beyond a bound.
template <class All>
bool print_table(const All& all, std::uint64_t scenes, std::uint64_t cycles, std::uint64_t refused) {
  const auto n = [](std::uint64_t x) { return static_cast<unsigned long long>(x); };
  std::printf(
      "%llu scenes, %llu cycles; %llu drawings refused\n\n"
      "| | worst | scenes beyond | seed of the worst |\n|---|---|---|---|\n",
      n(scenes), n(cycles), n(refused));
  bool good = true;
  for (const Found* f : all) {
    std::printf("| %s | %.6g | %llu | %llu |\n", f->what, f->worst, n(f->scenes), n(f->seed));
    good = good && (!f->judged || f->scenes == 0);
  }
  return good;
}
/// `make()`, or nothing where it refuses its numbers.
template <class Make>
auto unless_refused(bool trace, const Make& make) -> std::optional<decltype(make())> {
  try {
    return make();
  } catch (const skinctl::ConfigurationError& e) {
    if (trace) std::printf("refused: %s\n", e.what());
    return {};
  }
}
/// `ATTACK [CYCLES = 500 000] [SEED = 1]` runs scenes, `ATTACK run SEED` one, and tells of it. 1: a bound was
/// passed.
template <class Findings>
int attack_main(int argc, char** argv, void (*run)(std::uint64_t seed, Findings& found, bool trace)) {
  Findings found;
  if (argc > 2 && std::strcmp(argv[1], "run") == 0) {
    run(std::strtoull(argv[2], nullptr, 10), found, true);
    return 0;
  }
  const std::uint64_t cycles = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 500'000;
  std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  while (found.cycles < cycles) run(seed++, found, false);
  return print_table(found.all(), found.scenes, found.cycles, found.refused) ? 0 : 1;
}
/// The scene with the limits that its parts `P` name.
template <class P, class Scene>
auto with_limits(const Scene& scene, const skinctl::MaxJerk<6>& jerk, const skinctl::MaxToolSpeed<5>& tool) {
  if constexpr (P::jerk && P::tool) {
    return scene.with(jerk, tool);
  } else if constexpr (P::jerk) {
    return scene.with(jerk);
  } else if constexpr (P::tool) {
    return scene.with(tool);
  } else {
    return scene;
  }
}
inline void print_reasons(skinctl::Status status) {
  for (const skinctl::Fault& f : skinctl::faults)
    if (status.has(f.reason))
      std::printf(" %.*s", int(std::string_view(f.name).size()), std::string_view(f.name).data());
}

inline constexpr skinctl::JointPosition<6> home{0.0, -1.2, 1.4, -1.8, -1.57, 0.3};
inline constexpr std::size_t cells = 6;
using Forces = std::array<double, cells>;  ///< on the cells, against their normals [N]

inline const std::vector<skinctl::PlacedCell<2>>& forearm() {
  using skinctl::testing::cell_at;
  static const std::vector<skinctl::PlacedCell<2>> placed{cell_at<2>(1, {-0.2, 0.04, 0.02}, {0, 1, 0}),
                                                          cell_at<2>(2, {-0.2, -0.04, 0.02}, {0, -1, 0}),
                                                          cell_at<2>(3, {-0.25, 0, 0.06}, {0, 0, 1})};
  return placed;
}
inline const std::vector<skinctl::PlacedCell<5>>& hand() {
  using skinctl::testing::cell_at;
  static const std::vector<skinctl::PlacedCell<5>> placed{cell_at<5>(4, {0, 0.04, 0.02}, {0, 1, 0}),
                                                          cell_at<5>(5, {0.04, 0, 0.02}, {1, 0, 0}),
                                                          cell_at<5>(6, {0, 0, 0.05}, {0, 0, 1})};
  return placed;
}
inline auto skin() {
  using namespace skinctl::testing;
  return open_skin(skinctl::Patch<2, 3>(forearm(), open_gains), skinctl::Patch<5, 3>(hand(), open_gains));
}
/// What the cells send.
inline std::array<skinctl::CellSample, cells> samples(const Forces& force, skinctl::Nanoseconds now) {
  std::array<skinctl::CellSample, cells> out{};
  for (std::size_t c = 0; c < cells; ++c) {
    out[c].time = now, out[c].cell = static_cast<std::uint32_t>(c + 1);
    out[c].force.fill(static_cast<float>(std::min(1.0, force[c] / (3 * skinctl::testing::newtons_per_unit))));
  }
  return out;
}
/// What the pushes do to the joints [N m].
inline skinctl::JointTorque<6> pushes(const skinctl::JointPosition<6>& q, const Forces& force) {
  using namespace skinctl;
  JointTorque<6> tau;
  const auto add = [&]<std::size_t I>(const std::vector<PlacedCell<I>>& placed) {
    const Poses<ur5::Model, closure<ur5::Model>(link_bit<I>)> poses(ur5::Model{}, q);
    for (const auto& cell : placed) {
      const double f = force[cell.id - 1];
      if (f == 0) continue;
      const Xyz<double> push = -f * (poses.template get<I>() * cell.X_LC).axis_z();
      jacobian<I>(poses, cell.X_LC).for_each([&](auto i, const auto& column) {
        tau[i.value] += dot(column.linear, push);
      });
    }
  };
  add(forearm()), add(hand());
  return tau;
}
inline skinctl::Xyz<double> tool_at(const skinctl::JointPosition<6>& q) {
  using namespace skinctl;
  return Poses<ur5::Model, closure<ur5::Model>(link_bit<5>)>(ur5::Model{}, q).get<5>().origin();
}

/// A joint that turns twice swings with the least of the peaks between its turns.
class Swings {
 public:
  /// @param rests  speed below which a joint does not turn [rad/s].
  explicit Swings(double rests) : rests_(rests) {}
  void take(const skinctl::JointVelocity<6>& v) {
    for (std::size_t i = 0; i < 6; ++i) {
      if (v[i] * peak_[i] < 0 && std::abs(v[i]) > rests_) {
        if (++turns_[i] > 1) worst_ = std::max(worst_, std::abs(peak_[i]));
        peak_[i] = 0;
      }
      if (std::abs(v[i]) > std::abs(peak_[i]) && v[i] * peak_[i] >= 0) peak_[i] = v[i];
    }
  }
  [[nodiscard]] double worst() const { return worst_; }

 private:
  double rests_, worst_ = 0;
  skinctl::JointVelocity<6> peak_;  ///< since each joint turned last
  std::array<int, 6> turns_{};
};

}  // namespace attacks

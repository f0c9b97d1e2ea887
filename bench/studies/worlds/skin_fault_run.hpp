// A UR5 with 260 cells, some of which are faulty: what its skin makes of them, against what it makes of
// healthy ones.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>

#include "skinctl/skinctl.hpp"
#include "skinctl/tactile/detail/inward_way.hpp"
#include "skinctl/testing/skin_faults.hpp"
#include "skinctl/testing/skin_signals.hpp"
#include "tests/support/robots.hpp"

namespace skinctl::testing {

struct SkinFaultRun {
  FaultyCell fault;  ///< of each faulty cell; `cell`, `source` and `from` are set by the run
  /// In place of `fault`: the mean of the force readings of each faulty cell, by the time since `begins` [s];
  /// with `noise`.
  std::function<double(double)> reads{};
  double noise = 0.7;        ///< of each force sensor that `reads` something [steps]
  double share = 0;          ///< of the cells; 0: one cell and its neighbours
  std::size_t together = 1;  ///< number of neighbouring cells that fail in one moment, where `share` is 0
  bool changes = false;      ///< cells send changes and, every 100 ms, keep-alives; else all that they read
  bool touched = true;       ///< hands press the arm at three places, one of them on the first faulty cell
  bool there = true;         ///< if not, on none of the faulty cells
  double radius = 1.6;       ///< of each touch [pitches]
  double tremor = 0.05;      ///< of each hand, as a share of its force
  /// Stiffness of the hands [N/m]: each presses with `hand_force` less this times the way that the arm has
  /// given; 0: their forces are as they are, whatever the arm does.
  double hand_stiffness = 0;
  double hand_force = 20;     ///< [N]
  bool believes_all = false;  ///< the healthy arm has a skin that believes its cells
  bool moves = false;         ///< the arm gives way
  Nanoseconds length = 6s, begins = 2s;
  std::uint64_t seed = 1;
};

/// Torques are those that act on the joints, as the root of the sum of squares, averaged over time from
/// `begins` on.
struct SkinFaultResult {
  double torque = 0;   ///< of the healthy skin [N m]
  double plain = 0;    ///< error of a skin that believes its cells
  double error = 0;    ///< error of the trusted skin
  double settled = 0;  ///< the same from 2 s after the faults begin
  std::size_t faulty = 0, found = 0;
  std::vector<double> time_to_find;  ///< [s], of those found, in rising order
  std::size_t false_masks = 0;       ///< cells that are masked at some time and have no fault
  double cell_seconds = 0;           ///< of healthy cells
  double motion = 0;  ///< largest distance of the wrist from that of an arm with a healthy skin [mm]
  double way = 0;     ///< largest way of that one [mm]
  double peak = 0,
         healthy_peak = 0;  ///< greatest force of a hand on each of these arms, if hands are springs [N]

  [[nodiscard]] double percentile(double p) const {
    return time_to_find.empty()
               ? 0
               : time_to_find[static_cast<std::size_t>(p * static_cast<double>(time_to_find.size() - 1))];
  }
};

/// The robot: it takes positions, and its Coulomb friction is 5 % of the joints' largest torques.
inline auto friction_arm() {
  RobotConfiguration<6> c{
      .limits = limits_of<ur5::Description>(15.0), .period = 8ms, .delay = 8ms, .virtual_damping = 0};
  c.viscous_friction = {20, 20, 15, 3, 3, 3};
  for (std::size_t j = 0; j < 6; ++j) c.coulomb_friction[j] = 0.05 * ur5::Description::max_torque[j];
  return by_position(ur5::Model{}, c);
}
/// The gains of its cells: three sensors at 0.9 are 52 N.
inline constexpr CellGains fault_gains{.force = 20, .proximity = 0};

/// What the run trusts with.
inline TrustSettings fault_trust(const SkinSignalSettings& signals, std::span<const CellPlace> places,
                                 bool changes = false) {
  TrustSettings t;
  if (changes) t.health.delta = SendOnDelta::Deltas{}.force / signals.step;
  t.noise = {{.force = static_cast<float>(signals.noise),
              .proximity = static_cast<float>(signals.noise),
              .rest = static_cast<float>(signals.rest / signals.step)}};
  t.lone_force = lone_forces(friction_arm(), places);
  return t;
}

/// The first `count` cells of a walk over the graph from `start` on, neighbours first.
[[nodiscard]] inline std::vector<std::size_t> cells_around(const CellGraph& graph, std::size_t start,
                                                           std::size_t count) {
  std::vector<std::size_t> found{start};
  for (std::size_t k = 0; k < found.size() && found.size() < count; ++k)
    for (const std::size_t n : graph.neighbours(found[k]))
      if (found.size() < count && std::find(found.begin(), found.end(), n) == found.end()) found.push_back(n);
  return found;
}

[[nodiscard]] inline SkinFaultResult run(const SkinFaultRun& r) {
  const auto patches = ur5::skin_patches<260>(fault_gains);
  const auto places = cell_places(patches);
  const auto plain = ur5_skin<260>(fault_gains);
  SkinSignals signals(places, {}, r.seed);
  const TrustedSkin trusted(plain, fault_trust(signals.settings(), places, r.changes));
  std::vector<std::uint32_t> ids;
  for (std::uint32_t i = 1; i <= 260; ++i) ids.push_back(i);
  FaultyCell like = r.fault;
  like.from = r.begins;
  std::vector<FaultyCell> faults =
      SkinFaults::of_share(r.share > 0 ? r.share : 1.0 / 260, ids, like, r.seed + 7);
  if (r.share == 0) {
    const FaultyCell one = faults[0];
    faults.clear();
    for (const std::size_t i : cells_around(trusted.fill().graph(), 40 + r.seed * 67 % 210, r.together)) {
      faults.push_back(one);  // links 1 to 4
      faults.back().cell = ids[i];
    }
  }
  if (r.touched) {
    const auto pitch = patch_pitches(places);
    Normal normal(r.seed);
    for (std::size_t k = 0; k < 3; ++k) {
      const bool on_it = k == 0 && like.fault != CellFault::cross_talk && r.there;
      const auto apart = [&](std::size_t i) {
        const auto way = places[i].place - places[faults[0].cell - 1].place;
        return places[i].link != places[faults[0].cell - 1].link || dot(way, way) > 0.2 * 0.2;
      };
      std::size_t i = on_it ? faults[0].cell - 1 : 40 + normal.bits()() % 215;
      while (!r.there && !apart(i)) i = 40 + normal.bits()() % 215;
      signals.touches.push_back({.link = places[i].link,
                                 .place = places[i].place,
                                 .radius = r.radius * pitch[places[i].patch],
                                 .reading = normal.between(0.1, 0.4) * (r.hand_stiffness > 0 ? 0 : 1),
                                 .from = Nanoseconds(500ms) + Nanoseconds(std::int64_t(k) * 100'000'000),
                                 .until = r.length + 1s,
                                 .tremor = r.tremor});
    }
    for (std::size_t k = 0; k < faults.size(); ++k)  // what is heard elsewhere is a touch
      if (like.fault == CellFault::cross_talk) {
        std::size_t best = 0;
        for (std::size_t i = 0; i < 260; ++i)
          if (ids[i] != faults[k].cell && places[i].link != places[faults[k].cell - 1].link &&
              signals.force(i, 1s) > signals.force(best, 1s))
            best = i;
        faults[k].source = ids[best];
      }
  }
  SkinFaults spoil(faults, r.seed + 3);

  auto a = std::make_unique<decltype(plain.start(0ns))>(plain.start(0ns)),
       b = std::make_unique<decltype(plain.start(0ns))>(*a);
  auto c = std::make_unique<decltype(trusted.start(0ns))>(trusted.start(0ns)),
       d = std::make_unique<decltype(trusted.start(0ns))>(*c);
  const ur5::Model model;
  const JointPosition<6> rest_at{0.0, -1.2, 1.4, -1.7, -1.5, 0.0};
  const auto law = SkinJointControl{} + GravityControl{};
  const Cycle arm(friction_arm(), trusted, law);
  TrustSettings believing = trusted.trust();
  if (r.believes_all)
    believing.lone_force = {std::numeric_limits<double>::infinity()}, believing.find_faults = false;
  const Cycle healthy_arm(friction_arm(), TrustedSkin(plain, believing), law);
  auto healthy_memory = std::make_unique<typename decltype(arm)::Memory>();
  auto faulty_memory = std::make_unique<typename decltype(arm)::Memory>();
  State<6> healthy_at{0ns, rest_at, {}}, faulty_at = healthy_at;
  if (r.moves) arm.start(*healthy_memory, healthy_at), arm.start(*faulty_memory, faulty_at);

  SkinFaultResult out;
  std::vector<double> found(260, -1);
  std::vector<bool> falsely(260);
  std::vector<CellSample> samples, spoilt;
  const SendOnDelta sender(SendOnDelta::Deltas{});
  std::vector<SendOnDelta::Memory> told(260), spoilt_told(260);
  const auto only_changes = [&](std::vector<SendOnDelta::Memory>& of, std::vector<CellSample>& all) {
    if (r.changes) std::erase_if(all, [&](const CellSample& s) { return !sender.send(of[s.cell - 1], s); });
  };
  Normal dither(r.seed + 11);
  SkinSignals healthy_signals = signals;
  std::vector<CellPlace> pressed_at;
  std::vector<double> shape;  // push of all cells for a reading of 1 at the centre [N]
  for (std::size_t k = 0; k < signals.touches.size() && r.hand_stiffness > 0; ++k) {
    SkinTouch& touch = signals.touches[k];
    touch.reading = 1;
    shape.push_back(0);
    for (std::size_t i = 0; i < 260; ++i) {
      SkinSignals one(places, {});
      one.touches = {touch};
      one.touches[0].tremor = 0;
      shape.back() += 3 * fault_gains.force * one.force(i, touch.from + 200ms);
      if (places[i].link == touch.link &&
          dot(places[i].place - touch.place, places[i].place - touch.place) == 0)
        pressed_at.push_back(places[i]);
    }
    touch.reading = 0;
  }
  const auto press = [&](SkinSignals& of, const State<6>& at) {
    double most = 0;
    for (std::size_t k = 0; k < shape.size(); ++k) {
      const skinctl::detail::InwardWay<ur5::Model, all_links(6), double> way(model, rest_at, at.q);
      const auto numbers = [](const Xyz<double>& v) {
        return std::array{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
      };
      const double given =
          double(way(pressed_at[k].link, numbers(pressed_at[k].place), numbers(pressed_at[k].normal)));
      const double force = std::max(0.0, r.hand_force - r.hand_stiffness * given);
      of.touches[k].reading = force / shape[k];
      most = std::max(most, force);
    }
    return most;
  };
  double cycles = 0, later = 0;
  auto begin = link_poses(model, rest_at).template get<5>().origin();
  for (Nanoseconds to = 8ms; to <= r.length; to += 8ms) {
    if (r.hand_stiffness > 0 && r.moves) {
      const double healthy = press(healthy_signals, healthy_at), faulty = press(signals, faulty_at);
      if (to > 600ms)
        out.peak = std::max(out.peak, faulty), out.healthy_peak = std::max(out.healthy_peak, healthy);
      signals.samples(to, spoilt);
      healthy_signals.samples(to, samples);
    } else {
      signals.samples(to, samples);
      spoilt = samples;
    }
    if (!r.reads) spoil.apply(spoilt, to);
    for (CellSample& s : spoilt) {
      if (!r.reads || s.time < r.begins || !spoil.faulty(s.cell, s.time)) continue;
      const double mean = r.reads(seconds<double>(s.time - r.begins));
      for (float& x : s.force) {
        const double steps = std::round(mean * 1024 + r.noise * dither());
        x = static_cast<float>(std::clamp(steps / 1024, 0.0, 1.0));
      }
    }
    only_changes(told, samples), only_changes(spoilt_told, spoilt);
    if (r.moves) {
      const auto step = [&](const auto& of, auto& memory, State<6>& at, std::span<const CellSample> sent) {
        typename decltype(arm)::Input input;
        at.time = input.now = to;
        input.measured = at, input.samples = sent;
        at.q = of.step(memory, input).command.position;
        return link_poses(model, at.q).template get<5>().origin();
      };
      const auto length = [](const auto& way) { return 1e3 * std::sqrt(dot(way, way)); };
      const auto here = step(healthy_arm, *healthy_memory, healthy_at, samples);
      if (to == 8ms) begin = here;
      out.motion = std::max(out.motion, length(step(arm, *faulty_memory, faulty_at, spoilt) - here));
      out.way = std::max(out.way, length(here - begin));
    }
    typename decltype(plain)::Wrenches w[4];
    plain.receive(*a, samples, to - 8ms, to, 1, &w[0]);
    plain.receive(*b, spoilt, to - 8ms, to, 1, &w[1]);
    trusted.receive(*c, spoilt, to - 8ms, to, 1, &w[2]);
    trusted.receive(*d, samples, to - 8ms, to, 1, &w[3]);
    for (std::size_t i = 0; i < 260; ++i) {
      const bool of_arm = r.moves && arm.skin().mask(faulty_memory->skin, i) > 0.5f;
      const bool masked = of_arm || trusted.mask(*c, i) > 0.5f, bad = spoil.faulty(ids[i], to);
      if (masked && bad && found[i] < 0) found[i] = seconds<double>(to - r.begins);
      if (masked && !bad) falsely[i] = true;
      if (!bad) out.cell_seconds += 0.008;
      if (bad && r.fault.fault == CellFault::unheard && found[i] < 0 && !c->hears(i))
        found[i] = seconds<double>(to - r.begins);
    }
    if (to <= r.begins) continue;
    const auto tau = [&](std::size_t k) { return skin_torque(model, rest_at, w[k]); };
    const auto size = [](const JointTorque<6>& t) {
      double sum = 0;
      for (const double x : t) sum += x * x;
      return std::sqrt(sum);
    };
    const double error = size(tau(2) - tau(3));
    out.torque += size(tau(3)), out.plain += size(tau(1) - tau(0)), out.error += error, cycles += 1;
    if (to > r.begins + 2s) out.settled += error, later += 1;
  }
  out.torque /= cycles, out.plain /= cycles, out.error /= cycles, out.settled /= std::max(later, 1.0);
  out.faulty = faults.size();
  for (std::size_t i = 0; i < 260; ++i) {
    if (found[i] >= 0) out.time_to_find.push_back(found[i]);
    out.false_masks += falsely[i] ? 1u : 0u;
  }
  out.found = out.time_to_find.size();
  std::sort(out.time_to_find.begin(), out.time_to_find.end());
  return out;
}

}  // namespace skinctl::testing

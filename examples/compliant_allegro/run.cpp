#include "examples/compliant_allegro/run.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "examples/adapters/allegro/driver.hpp"
#include "examples/adapters/allegro/palm.hpp"
#include "examples/compliant_allegro/scene.hpp"
#include "examples/compliant_allegro/touches.hpp"
#include "examples/simulated_allegro/simulated_hand.hpp"
#include "examples/support/text.hpp"
#include "skinctl/guard/faults.hpp"
#include "skinctl/hardware/loop.hpp"
#include "skinctl/hardware/scheduling.hpp"

namespace compliant_allegro {
namespace {

using namespace skinctl;
using namespace adapters::allegro;
using examples::text;
using examples::job::Exit;

/// While the hand holds something, what its cells feel of that is no touch to give way to: readings count
/// above `level` only.
template <class Skin>
struct GripSkin {
  Skin skin;
  float level = 0;
  std::array<CellSample, 16> counted{};

  std::span<const CellSample> poll() noexcept {
    const auto samples = skin.poll();
    for (std::size_t k = 0; k < samples.size(); ++k) {
      counted[k] = samples[k];
      for (float& f : counted[k].force) f = std::max(0.0F, f - level);
    }
    return {counted.data(), samples.size()};
  }
};

template <class Link>
Exit run_on(Link link, const Settings& s, const std::atomic<bool>& stop,
            simulated_allegro::SimulatedHand* simulated, RunLog& log) {
  HandOptions options;
  options.generation = s.generation;
  options.side = s.side;
  options.hand = s.hand;
  options.full_torque = s.full_torque;
  options.geared = s.geared;
  const bool lock_step = simulated != nullptr && s.speed == 0;
  if (lock_step) options.stamps = Stamps::counted;
  Driver<Link> driver(std::move(link), options, {.give_up = adapters::Timeout(lock_step ? 4000 : 100)});
  driver.connect();
  const Introduction& who = driver.introduction();
  constexpr const char* names[] = {"V4", "V5", "V5 Sense"};
  log.title = std::string("Allegro Hand ") + names[static_cast<int>(s.generation)] +
              (who.side == Side::right ? ", right" : ", left") + (simulated != nullptr ? ", simulated" : "");
  if (!s.quiet)
    std::printf("%s, serial %s%s, %.0f Hz\n", log.title.c_str(), who.serial.c_str(),
                who.gears == Gears::geared ? ", geared" : "", 1e3 / milliseconds(driver.period()));
  if (who.gears == Gears::unknown)
    std::fprintf(
        stderr,
        "compliant_allegro: is this hand (%s) geared in joints 1, 5 and 9? The maker's pages and drivers "
        "contradict each other about its letter. Assumed is the smaller torque: half the current there, and "
        "at most half of it. --geared yes or no says it.\n",
        who.serial.c_str());
  // A second process that outlives a crash of this one.
  std::optional<Guardian> guardian;
  if (simulated == nullptr) guardian.emplace(driver.link().handle(), driver.link().last_words());
  if (!lock_step && !s.quiet) std::printf("%s", request_real_time().report.c_str());

  const auto scene = make_scene(s, who.side, driver.scale(), driver.period(), driver.estimator().lag());
  using Scene = std::remove_cvref_t<decltype(scene)>;
  const auto memory = std::make_unique<typename Scene::Memory>();
  GripSkin<TactileSkin<Driver<Link>>> skin{TactileSkin(driver, false)};
  const double seconds_of_cycle = seconds<double>(driver.period());
  const auto planned = static_cast<std::uint64_t>(s.duration / seconds_of_cycle);
  log.entries.reserve(planned);
  examples::job::Progress progress(s.quiet);
  Nanoseconds first{}, felt_at{};
  std::uint64_t felt = 0, passed_on = 0;
  std::size_t next_goal = 0;
  Status all;
  bool blind = false;
  std::array<double, 4> squeeze{}, ball{};
  std::size_t squeezed = 0;
  double closes = 1e9, opens = 1e9;
  for (const Goal& g : s.task) {
    if (std::string_view(g.name) == "close") closes = g.at;
    if (std::string_view(g.name) == "open" && g.at > closes) opens = g.at;
  }

  // The first joints of a left hand's fingers turn about the same axis, so a mirrored posture has them
  // negated.
  const auto goal_of = [&](std::size_t k) {
    JointPosition<16> q(s.task[k].q);
    for (std::size_t i = 0; i < 12 && who.side == Side::left; i += 4) q[i] = -q[i];
    return q;
  };
  const auto before = [&](typename Scene::Input& input, typename Scene::Memory&) {
    if (first == 0ns) first = felt_at = input.now;
    if (s.palm != nullptr && s.palm->left()) return false;
    const double t = seconds<double>(input.now - first);
    if (const auto number = driver.condition().tactile_number; number != felt)
      felt = number, felt_at = input.now;
    if (s.generation == Generation::v5_sense && input.now - felt_at > 500ms) {
      blind = true;
      return false;
    }
    const double held = std::min({1.0, (t - closes) / 0.5, (opens + 1 - t) / 0.5});
    skin.level = static_cast<float>(s.grip_level * std::max(0.0, held));
    if (next_goal < s.task.size() && t >= s.task[next_goal].at) {
      input.goal = {goal_of(next_goal), nanoseconds(s.task[next_goal].duration)};
      ++next_goal;
    }
    return true;
  };
  const auto after = [&](const typename Scene::Input& input, const typename Scene::Output& out,
                         const Stopwatch&) {
    LogEntry e;
    e.time = seconds<double>(input.now - first);
    e.status = out.status.bits();
    all |= out.status;
    const auto goal = next_goal == 0 ? input.measured.q : goal_of(next_goal - 1);
    for (std::size_t i = 0; i < 16; ++i) {
      e.q[i] = static_cast<float>(input.measured.q[i]);
      e.target[i] = static_cast<float>(goal[i]);
      e.torque[i] = static_cast<float>(out.command.torque[i]);
      e.cell[i] = static_cast<float>(std::min(1.0, driver.condition().tactile[i] / 1020.0));
    }
    if (s.palm != nullptr && driver.condition().tactile_number != passed_on) {
      passed_on = driver.condition().tactile_number;
      s.palm->put(std::max(0.0F, e.cell[0] - skin.level));  // what it holds is no touch
    }
    if (e.time > opens - 1 && e.time < opens) {
      ++squeezed;
      std::array<double, 16> force{};
      if (simulated != nullptr) force = simulated->snapshot().ball_force;
      for (std::size_t k = 0; k < 16; ++k) {
        if (k % 4 != 0) squeeze[k / 4] += std::abs(double(e.torque[k])) / 3;
        ball[k / 4] += force[k];
      }
    }
    if (log.entries.size() < log.entries.capacity()) log.entries.push_back(e);
    if (progress.due(e.time)) {
      const auto most = std::max_element(e.cell.begin(), e.cell.end());
      progress.show("%5.0f s  %d C  firmest touch %.2f on cell %d", e.time, driver.condition().temperature,
                    double(*most), static_cast<int>(most - e.cell.begin()));
    }
  };

  LoopOptions loop;
  loop.cycles = planned;
  loop.period = driver.period();
  loop.stop = &stop;
  const auto result = run_loop(scene, *memory, driver, skin, loop, before, after);
  progress.clear();

  log.cycles = result.cycles;
  log.silent = result.silent;
  log.missed = lock_step ? 0 : result.missed;
  log.incomplete = driver.condition().incomplete;
  log.duplicates = driver.condition().duplicates;
  const auto us = [](Nanoseconds t) { return 1e3 * milliseconds(t); };
  log.median_us = us(result.whole.percentile(0.5));
  log.p99_us = us(result.whole.percentile(0.99));
  log.max_us = us(result.whole.max());
  log.task = s.task;
  for (std::size_t f = 0; f < 4 && squeezed > 0; ++f) {
    log.squeeze[f] = squeeze[f] / double(squeezed);
    log.ball[f] = ball[f] / double(squeezed);
  }
  if (s.generation != Generation::v5_sense)  // no cell, no stale sample
    all = all.without(Reason::sample_stale);
  for (std::size_t r = 0; r < static_cast<std::size_t>(Reason::count); ++r)
    if (all.has(static_cast<Reason>(r)))
      log.status += (log.status.empty() ? "" : ", ") + std::string(name(static_cast<Reason>(r)));
  find_touches(s, who.side, closes, opens, log);
  if (simulated != nullptr) {
    const auto acts = [&] {
      log.last = simulated->snapshot();
      return log.last.torque != PerJoint{} || (log.last.servo && s.generation != Generation::v5_sense);
    };
    for (int k = 0; k < 300 && acts(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  log.facts = {
      {"cycles", std::to_string(log.cycles)},
      {"of these without a state", std::to_string(log.silent)},
      {"states later than 1.5 periods", std::to_string(log.missed)},
      {"sets of positions of which a part was lost", std::to_string(log.incomplete)},
      {"duplicates", std::to_string(log.duplicates)},
      {"reasons", log.status.empty() ? "none" : log.status},
      {"time of a cycle", text("%.1f us median, ", log.median_us) + text("%.1f us p99, ", log.p99_us) +
                              text("%.1f us longest", log.max_us)}};

  if (result.ended == LoopEnd::interrupted) return log.reason = "interrupted", Exit::interrupted;
  if (result.ended == LoopEnd::lost || result.ended == LoopEnd::no_state) {
    log.reason = driver.error();
    return driver.halted() ? Exit::halted : Exit::lost;
  }
  if (result.ended == LoopEnd::displaced)
    return log.reason = "the hand stood elsewhere than its first state said", Exit::not_following;
  if (blind) return log.reason = "the tactile cells have fallen silent", Exit::blind;
  return Exit::fine;
}

}  // namespace

void default_task(Settings& s) {
  // Of a right hand: the outer fingers lean towards the middle one when they close.
  const PerJoint open = {0, 0.3, 0.3, 0.3, 0, 0.3, 0.3, 0.3, 0, 0.3, 0.3, 0.3, 0.9, 0.3, 0.3, 0.3};
  const PerJoint closed = {-0.25, 1.0, 0.9, 0.7, 0, 1.0, 0.9, 0.7, 0.25, 1.0, 0.9, 0.7, 1.3, 0.4, 0.7, 0.7};
  s.task = {{0.2, open, 1.5, "open"}, {9, closed, 2, "close"}, {14, open, 1.5, "open"}};
  s.plant.touches = {{.cell = 3, .start = 3, .duration = 1.5, .force = 0.6},
                     {.cell = 10, .start = 6, .duration = 1.5, .force = 0.8}};
  s.plant.ball = simulated_allegro::Ball{};
}

Exit run(const Settings& s, const std::atomic<bool>& stop, RunLog& log) {
  const auto tty = [](const std::string& name) { return name.find('/') != std::string::npos; };
  if (!s.udp.empty()) return run_on(UdpHand(s.udp, s.udp_port), s, stop, nullptr, log);
  if (!s.can.empty() && tty(s.can)) return run_on(CanHand(SlcanLink::open(s.can)), s, stop, nullptr, log);
  if (!s.can.empty()) return run_on(CanHand(FrameSocket::open(s.can)), s, stop, nullptr, log);
  simulated_allegro::Config config;
  config.generation = s.generation;
  config.hand = s.hand;
  config.full_torque = s.full_torque;
  config.speed = s.speed;
  config.plant = s.plant;
  config.plant.side = s.side.value_or(Side::right);
  config.faults = s.faults;
  simulated_allegro::SimulatedHand hand(config);
  if (s.simulate_udp) return run_on(UdpHand("127.0.0.1", hand.udp()), s, stop, &hand, log);
  return run_on(CanHand(hand.pair()), s, stop, &hand, log);
}

}  // namespace compliant_allegro

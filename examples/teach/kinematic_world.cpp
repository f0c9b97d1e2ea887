#include "examples/teach/kinematic_world.hpp"

#include <chrono>
#include <cstdio>
#include <set>
#include <thread>

#include "skinctl/semantics/executor.hpp"

namespace teach {
namespace {
using namespace skinctl;
using skinctl::testing::uniform;
constexpr auto cycle = 8ms;

/// Things at random places, and a hand.
class World {
 public:
  World(const NamedTask& named, int count, std::uint64_t seed)
      : t_(named.task), random_(testing::seeded(seed)) {
    std::set<ObjectClass> many, one;
    for (std::size_t i = 0; i < t_.size; ++i)
      if (t_.steps[i].does == &activity::Look::rule)
        (t_.steps[i].no == ask_person ? one : many).insert(t_.steps[i].role);
    for (std::size_t i = 0; i < t_.place_count; ++i)
      if (t_.places[i].mark != 0 && many.count(t_.places[i].mark) == 0) one.insert(t_.places[i].mark);
    for (const auto kind : one) {
      add(kind);
      for (int k = 0; k < 1000 && near(things.size() - 1) < 0.3; ++k) things.pop_back(), add(kind);
    }
    landmarks_ = things.size();
    for (const auto kind : many)
      for (int k = 0; k < count; ++k) add(kind);
  }
  /// A cycle of an activity that was asked for; true: it has ended.
  bool go_on(const StepRequest& r) {
    if (r.does == &activity::Look::rule) return look(r.role);
    if (r.does == &activity::Find::rule) return true;
    const bool there = move(goal(r));
    if (!there) return false;
    if (r.does == &activity::Take::rule) take();
    if (r.does == &activity::Release::rule) release();
    if (r.does == &activity::Reverse::rule) in_hand = false, target_ = things.size();
    if (r.does == &activity::Squeeze::rule && t_.steps[r.step].border != no_border)
      answer = things[target_].stiffness * (1 + uniform(random_, -0.05, 0.05)) >=
               t_.borders[t_.steps[r.step].border];
    return true;
  }
  /// What lies where: the landmark within 0.15 m of each thing that was put somewhere.
  void judge() {
    for (std::size_t i = landmarks_; i < things.size(); ++i)
      for (std::size_t k = 0; k < landmarks_; ++k)
        if (things[i].placed && norm(Xyz<double>(things[i].p - things[k].p)) < 0.15)
          things[i].ends_at = things[k].kind;
  }
  std::vector<WorldThing> things;
  bool in_hand = false, answer = true;

 private:
  void add(ObjectClass kind) {
    things.push_back({kind,
                      {uniform(random_, -0.6, 0.6), uniform(random_, -0.6, 0.6), uniform(random_, 0.0, 0.1)},
                      uniform(random_, 0.0, 1.0) < 0.5 ? uniform(random_, 1100.0, 1400.0)
                                                       : uniform(random_, 2700.0, 3300.0),
                      0,
                      false});
  }
  /// From thing `i` to the nearest before it [m].
  [[nodiscard]] double near(std::size_t i) const {
    double out = 1e9;
    for (std::size_t k = 0; k < i; ++k) out = std::min(out, norm(Xyz<double>(things[k].p - things[i].p)));
    return out;
  }
  /// The nearest thing of this class that nothing was done with; the answer is no if there is none.
  bool look(ObjectClass kind) {
    double nearest = 1e9;
    target_ = things.size();
    for (std::size_t i = 0; i < things.size(); ++i) {
      const double d = norm(Xyz<double>(things[i].p - hand_));
      if (things[i].kind == kind && !things[i].placed && d < nearest) nearest = d, target_ = i;
    }
    answer = target_ < things.size();
    return true;
  }
  [[nodiscard]] Xyz<double> goal(const StepRequest& r) const {
    if (r.does == &activity::Reverse::rule || r.place >= t_.place_count) return hand_ + Xyz<double>{0, 0, 0};
    const TaughtPlace& p = t_.places[r.place];
    Xyz<double> at = p.X_MH.origin();
    const bool takes = r.does == &activity::ReachAbove::rule || r.does == &activity::Reach::rule ||
                       r.does == &activity::Take::rule;
    if (takes && target_ < things.size()) at = at + things[target_].p;
    for (const auto& thing : things)
      if (!takes && p.mark != 0 && thing.kind == p.mark && !thing.placed) at = p.X_MH.origin() + thing.p;
    return r.does == &activity::ReachAbove::rule ? Xyz<double>(at + Xyz<double>{0, 0, 0.1}) : at;
  }
  bool move(const Xyz<double>& to) {
    const Xyz<double> way = to - hand_;
    const double far = norm(way), most = 0.5 * seconds<double>(cycle);
    hand_ = far <= most ? to : Xyz<double>(hand_ + (most / far) * way);
    if (in_hand && target_ < things.size()) things[target_].p = hand_;
    return far <= most;
  }
  void take() { in_hand = target_ < things.size() && uniform(random_, 0.0, 1.0) > 0.1; }
  void release() {
    in_hand = false;
    if (target_ < things.size()) things[target_].placed = true;
  }

  const Task& t_;
  testing::Random random_;
  std::size_t target_ = 0, landmarks_ = 0;
  Xyz<double> hand_{0, 0, 0.4};
};
}  // namespace

RunResult run(const NamedTask& named, int count, std::uint64_t seed, double pace, bool tell,
              const std::atomic<bool>& stopped) {
  using Kind = StepRequest::Kind;
  World world(named, count, seed);
  const Executor<max_steps> executor(named.task);
  auto memory = executor.start(0ns);
  SkillReport report;
  RunResult out;
  Nanoseconds now{};
  const auto begun = std::chrono::steady_clock::now();
  for (bool asked = false; now < 4h && !stopped && !out.finished; now += cycle) {
    const Observed seen{fact::in_hand, world.in_hand ? fact::in_hand : fact::none};
    const auto next = executor.step(memory, {now, seen, report, world.answer, true, asked});
    memory = next.memory;
    const StepRequest& r = next.request;
    asked = r.kind == Kind::ask;
    out.questions += asked ? 1 : 0;
    out.finished = r.kind == Kind::finished || out.questions > 20;
    if (r.kind == Kind::start) {
      ++out.requests;
      out.failures += r.does == &activity::Reverse::rule ? 1 : 0;
      report = {r.ticket, SkillPhase::running, SkillFailure::none};
      world.answer = true;
      if (tell)
        std::printf("%8.2f s  %s the %s\n", seconds<double>(now), r.does->name,
                    named.classes.name(r.role).c_str());
    } else if (r.kind == Kind::go_on && report.phase == SkillPhase::running && world.go_on(r)) {
      report.phase = SkillPhase::finished;
    }
    const auto due = begun + std::chrono::duration<double>(pace > 0 ? seconds<double>(now) / pace : 0);
    while (!stopped && std::chrono::steady_clock::now() < due) std::this_thread::sleep_for(cycle);
  }
  out.finished = memory.phase == Executor<max_steps>::Phase::finished;
  world.judge();
  out.things = world.things;
  out.lasted = seconds<double>(now);
  return out;
}

}  // namespace teach

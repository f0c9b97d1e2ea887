// A study: two arms cross each other's way, and something else crosses theirs, a thousand times.
// `crossings [how many] [first seed] [seen|unseen]`: every second one with a rod or a ball that flies through at up to 0.3 m/s.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <memory>

#include "examples/packing_oranges/right_of_way.hpp"
#include "examples/packing_oranges/tomm.hpp"
#include "examples/packing_oranges/world.hpp"
#include "skinctl/clearance/retreat.hpp"
#include "skinctl/clearance/sightings.hpp"
#include "skinctl/control/spline_joint.hpp"
#include "skinctl/control/velocity_control.hpp"

namespace packing {
namespace {
using namespace skinctl;
using R = Ur5;
using A = Arm<R>;
using Model = A::Model;

constexpr double range = sight_range;

/// Skin all around each link and the hand, half spheres at the ends included: 498 cells a little larger than TUM's.
template <std::size_t I>
std::vector<PlacedCell<I>> cells_of(const Capsule<>& s, std::uint32_t first) {
  const Xyz<double> middle = 0.5 * (s.from + s.to), way = s.to - s.from;
  const double length = norm(way);
  const Xyz<double> z = (1 / length) * way,
                    x = std::abs(z.x) < 0.5 ? Xyz<double>{1, 0, 0} : Xyz<double>{0, 1, 0};
  const Xyz<double> across = cross(z, x), y = (1 / norm(across)) * across;
  const Transform<Link<I>, Surface> X_LS({cross(y, z), y, z}, middle);
  std::vector<PlacedCell<I>> out;
  for (const auto& X_SC : full_cover(CapsuleSurface{s.radius, length}, {1.2}))
    out.push_back({first++, (X_LS * X_SC).template renamed<Link<I>, Cell>()});
  return out;
}
constexpr std::size_t counts[] = {80, 128, 77, 34, 34, 19, 126};
Capsule<> shape(std::size_t k) {
  return k < 6 ? R::shapes[k]
               : Capsule<>{{0, 0, R::flange + 0.03}, {0, 0, R::flange + reach_of_gripper}, 0.08};
}
constexpr CellGains gains{.force = newtons_per_reading};
template <std::size_t K, std::size_t I = (K < 6 ? K : 5)>
Patch<I, counts[K]> patch() {
  std::uint32_t first = 1;
  for (std::size_t k = 0; k < K; ++k) first += static_cast<std::uint32_t>(counts[k]);
  const auto all = cells_of<I>(shape(K), first);
  if (all.size() != counts[K]) {
    std::fprintf(stderr, "part %zu has room for %zu cells\n", K, all.size());
    std::exit(1);
  }
  return Patch<I, counts[K]>(all, gains);
}

/// What is seen and not known is given way to by the whole arm: every joint moves as `Retreat` plans anew each cycle.
struct GiveWay {
  static constexpr const char* name = "give_way";
};
/// Back to the joints from where it gave way.
struct Return {
  static constexpr const char* name = "return";
};
constexpr auto skills = boost::hana::make_map(
    skill<Return>(
        recipe(load<controller::Gravity>(), load<controller::SkinJoint>(), load<controller::SplineJoint>())
            .when({.finish = SkillFinish::settled, .hold = 16ms})),
    skill<behaviour::Reaching>(recipe(load<controller::Gravity>(), load<controller::SkinJoint>(),
                                      load<controller::SplineOperational>())),
    skill<GiveWay>(
        recipe(load<controller::Gravity>(), load<controller::SkinJoint>(), load<controller::Velocity>())));

auto scene() {
  const auto arm = A::robot();
  SkinSettings settings;
  settings.force = EventGate<>::dead_band(0.02);
  const Skin<Model, double, Patch<0, counts[0]>, Patch<1, counts[1]>, Patch<2, counts[2]>,
             Patch<3, counts[3]>, Patch<4, counts[4]>, Patch<5, counts[5]>, Patch<5, counts[6]>>
      felt(patch<0>(), patch<1>(), patch<2>(), patch<3>(), patch<4>(), patch<5>(), patch<6>(), settings);
  auto o = operational_settings(arm);
  o.tracking.lambda = 40;
  o.tracking.K_c = 6;
  o.tracking.max_velocity = JointVelocity<6>::constant(2.0);
  o.max_linear_velocity = 1.0;
  o.max_angular_velocity = 3.0;
  return Cycle(
             arm, felt,
             skill_set<GiveWay>(
                 skills, {.bumpless_transfer = 40ms}, skill_controller<controller::Gravity>(GravityControl{}),
                 skill_controller<controller::SkinJoint>(SkinJointControl{}),
                 skill_controller<controller::Velocity>(VelocityControl<6>{}),
                 skill_controller<controller::SplineJoint>(SplineJoint(arm)),
                 skill_controller<controller::SplineOperational>(SplineOperational(A::tool(), o))))
      .with(A::clearance_empty_handed());
}
using Scene = decltype(scene());
using Set = Scene::law_type;

/// Where the parts of an arm are, in the world.
std::array<Capsule<>, 7> parts(std::size_t arm, const JointPosition<6>& q) {
  std::array<Capsule<>, 7> out;
  const auto poses = link_poses(Model{}, q);
  const auto X_WB = A::base(arm);
  const auto one = [&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
    const auto X = X_WB * poses.template get<I>();
    const auto put = [&](std::size_t k) {
      const Capsule<> s = shape(k);
      out[k] = {X.origin() + X.axes() * s.from, X.origin() + X.axes() * s.to, s.radius};
    };
    put(I);
    if constexpr (I == 5) put(6);
  };
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (one(std::integral_constant<std::size_t, I>()), ...);
  }(std::make_index_sequence<6>());
  return out;
}

/// One arm: goals, and what it does when it is kept from them.
class Mover {
 public:
  Mover(std::size_t arm, const Scene& scene, const State<6>& measured, std::uint64_t seed)
      : arm_(arm),
        scene_(scene),
        memory_(std::make_unique<Scene::Memory>()),
        sight_(Model{}, scene.skin().places(), {.range = range, .half_angle = sight_cone, .error = 0.01}),
        eyes_(scene.skin().places(), seed),
        retreat_(Model{}, A::clearance_empty_handed(), A::home()),
        samples_(eyes_.cells().size()) {
    for (std::size_t i = 0; i < samples_.size(); ++i) samples_[i].cell = static_cast<std::uint32_t>(i + 1);
    scene_.start(*memory_, measured);
    X_WH_ = A::base(arm_) * A::hand(measured.q);
    R_ = X_WH_.axes();
    goal_ = X_WH_.origin();
  }
  void send(const Xyz<double>& goal) {
    goal_ = goal;
    reached_ = false;
    back_ = true;
    tries_ = 0;
  }
  [[nodiscard]] auto occupied() const { return skinctl::occupied(scene_, *memory_, A::base(arm_)); }
  [[nodiscard]] bool reached() const { return reached_; }
  /// Whether it needs room that the other one has: at once where it gives way and comes near the other one, soon where
  /// the other one holds up its return.
  [[nodiscard]] bool waits() const {
    return way_.should_go() || (gave_way_ && (kept_ || room_ < 0.25)) ||
           (returns_ && now_ - free_at_ > 200ms);
  }
  [[nodiscard]] bool gives_way() const { return gave_way_; }
  [[nodiscard]] bool pressed() const { return now_ - pressed_at_ < 300ms; }
  [[nodiscard]] int asides() const { return way_.times(); }
  [[nodiscard]] bool kept() const { return kept_; }
  [[nodiscard]] std::size_t seen() const { return seen_; }
  [[nodiscard]] double time() const { return time_; }

  template <class Filled>
  auto step(const State<6>& measured, const Filled* other, const std::array<Capsule<>, 7>& own,
            const std::vector<Capsule<>>& around, bool other_waits, bool pressed) {
    const std::span samples = look(measured, around);
    const std::clock_t begun = std::clock();
    now_ = measured.time;
    X_WH_ = A::base(arm_) * A::hand(measured.q);
    reached_ = reached_ || norm(Xyz<double>(X_WH_.origin() - goal_)) < 0.01;
    way_.goes_first(arm_ == 0);
    // It slides along what keeps it: that alone is no progress.
    const double far = norm(Xyz<double>(X_WH_.origin() - goal_));
    const bool nearer = far < nearest_ - 0.01;
    if (nearer) nearest_ = far;
    if (kept_) kept_at_ = measured.time;
    way_.step(measured.time, measured.time - kept_at_ < 300ms && !reached_ && !gave_way_ && !returns_,
              !nearer);
    if (seen_ > 0) seen_at_ = measured.time;
    if (pressed) pressed_at_ = measured.time;
    const bool gives_way = sees_ && (measured.time - seen_at_ < 300ms || measured.time - pressed_at_ < 300ms);
    room_ = range + 1;
    if (gives_way)
      for (const Capsule<>& mine : own)
        for (std::size_t k = 0; k < own.size(); ++k)
          room_ = std::min(room_, distance(mine, around[k]).distance);
    if (gives_way) {
      if (!gave_way_) {
        if (!returns_) before_ = measured.q;
        returns_ = false;
        input_.goal = Set::start_skill(Set::index<GiveWay>());
        ++gave_;
      }
      back_ = gave_way_ = true;
    } else if (way_.is_aside()) {
      back_ = true;
    } else if (gave_way_) {
      gave_way_ = false, returns_ = true;
      input_.goal = Set::start_skill(Set::index<Return>());
      auto& to = input_.goal->goals.template of<JointGoal<6>>();
      to.has = true;
      double way = 0;
      for (std::size_t i = 0; i < 6; ++i) way = std::max(way, std::abs(before_[i] - measured.q[i]));
      to.goal = {before_, nanoseconds(std::max(0.5, 1.9 * way / 1.5))};
      return_by_ = measured.time + to.goal.duration + 4s;
      free_at_ = measured.time;
      input_.goal->ticket = ++ticket_;
    } else if (returns_) {
      const auto told = Set::report_of(memory_->law, ticket_);
      const bool done = told.phase == SkillPhase::finished && told.ticket == ticket_;
      if (!kept_) free_at_ = measured.time;
      // It waits while the other arm keeps it from its way; one that is at its goal makes room meanwhile.
      if (done || measured.time > return_by_ || measured.time - free_at_ > 2s) returns_ = false;
    } else if (back_ && !other_waits) {
      back_ = false;
      ask(goal_);
      nearest_ = far;
    } else if (!reached_ && !other_waits && measured.time > reach_by_) {
      // From joints that the hand cannot go straight from: by way of those at the start.
      before_ = A::home();
      gave_way_ = back_ = true;
    } else if (way_.should_go() && ++tries_ % 2 == 0) {
      // A step aside did not help: back to the joints at the start, on its own side.
      before_ = A::home();
      gave_way_ = back_ = true;
    } else if (way_.should_go() || other_waits) {
      Xyz<double> aside = X_WH_.origin();
      aside.x = -side(arm_) * (R::stands - 0.32);
      aside.z = std::max(aside.z, 0.2);
      ask(aside);
      way_.go();
      back_ = true;
    }
    input_.now = measured.time;
    input_.measured = measured;
    input_.around.count = 0;
    input_.around.time = measured.time;
    seen_ = 0;
    sees_ = other != nullptr;
    if (other != nullptr) {
      input_.around.add(A::base(arm_).inverse(), *other);
      // An arm that gives way and finds this one in its way is given way to like anything else.
      sight_.each_known(
          measured.q, [&](std::size_t i) { return samples[i].proximity; }, input_.around,
          [&](std::size_t i) {
            if (!pressed) samples[i].proximity = 0;
          });
      seen_ = sight_.look(
          measured.q,
          [&](std::size_t i) {
            return scene_.skin().held(memory_->skin, i).proximity * double(CellCounts::proximity_unit);
          },
          input_.around);
    }
    if (gives_way) {
      const bool by_arm = now_ - pressed_at_ < 300ms;
      if (!input_.goal) input_.goal.emplace();
      auto& wish = input_.goal->goals.template of<VelocityGoal<6>>();
      wish.has = true;
      wish.goal.velocity =
          retreat_(measured.q, input_.around,
                   by_arm ? decltype(retreat_)::Others::press : decltype(retreat_)::Others::stay);
    }
    input_.samples = samples;
    // A person sets right an arm that something pushed off its place.
    const bool free = measured.time - seen_at_ > 1s;
    input_.request = displaced_ && free ? CycleRequest::resume : CycleRequest::none;
    const auto out = scene_.step(*memory_, input_);
    input_.goal.reset();
    kept_ = out.status.has(Reason::clearance_kept);
    displaced_ = out.status.has(Reason::displaced);
    time_ += static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
    return out;
  }

 private:
  std::span<CellSample> look(const State<6>& measured, const std::vector<Capsule<>>& around) {
    const auto readings = eyes_.look(A::link_places(arm_, measured.q), around);
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      samples_[i].time = measured.time;
      samples_[i].proximity = static_cast<float>(readings[i]);
    }
    return samples_;
  }
  void ask(const Xyz<double>& to) {
    const double way = norm(Xyz<double>(to - X_WH_.origin()));
    const double time = std::max({0.3, std::sqrt(5.78 * way / 2.2), 1.875 * way / 0.8});
    input_.goal = Set::start_skill(Set::index<behaviour::Reaching>());
    auto& pose = input_.goal->goals.template of<PoseGoal<Tool>>();
    pose.has = true;
    reach_by_ = now_ + nanoseconds(time) + 5s;
    pose.goal = {A::base(arm_).inverse() * Transform<skinctl::World, Tool>(R_, to), nanoseconds(time)};
  }
  std::size_t arm_;
  const Scene& scene_;
  std::unique_ptr<Scene::Memory> memory_;
  Sightings<Model> sight_;
  Eyes eyes_;
  Retreat<Model, near_most> retreat_;
  std::vector<CellSample> samples_;
  Scene::Input input_;
  Transform<skinctl::World, Tool> X_WH_;
  Rotation<double> R_;
  Xyz<double> goal_{0, 0, 0};
  RightOfWay way_;
  bool reached_ = true, kept_ = false, back_ = false, gave_way_ = false, sees_ = true, displaced_ = false;
  Nanoseconds seen_at_{-1s}, kept_at_{-1s}, pressed_at_{-1s};
  double room_ = 0;     // between the arms, while it gives way [m]
  double nearest_ = 0;  // to the goal, since it was asked for [m]
  int gave_ = 0, tries_ = 0;
  bool returns_ = false;
  JointPosition<6> before_;
  Nanoseconds return_by_{}, reach_by_{}, free_at_{}, now_{};
  std::uint16_t ticket_ = 0;
  std::size_t seen_ = 0;
  double time_ = 0;
};

struct Result {
  int crossings = 0, waited = 0, aside = 0, stuck = 0, met = 0, own_fault = 0, at_walls = 0;
  std::array<int, 6> near{};  // nearest: below 0, 10, 20, 50, 100 mm, above
  double least = 1e9, longest = 0, time = 0, fastest_into = 0;

  void add(double nearest) {
    least = std::min(least, nearest);
    constexpr double edges[] = {0, 0.01, 0.02, 0.05, 0.1};
    ++near[static_cast<std::size_t>(std::upper_bound(edges, edges + 5, nearest) - edges)];
  }
  void print(const char* what) const {
    std::printf("%-22s %5d  touched %d (the arm itself moved into it: %d, at up to %.3f m/s)\n", what,
                crossings, met, own_fault, fastest_into);
    std::printf("  nearest %.1f mm; below 0: %d, to 10 mm: %d, to 20: %d, to 50: %d, to 100: %d, more: %d\n",
                1e3 * least, near[0], near[1], near[2], near[3], near[4], near[5]);
    std::printf(
        "  waited out %d, went aside in %d, not ended within 30 s: %d; longest %.1f s, mean %.2f s; at table "
        "or "
        "walls in %d\n",
        waited, aside, stuck, longest, time / std::max(1, crossings), at_walls);
  }
};

int study(int number, std::uint64_t seed, bool sees) {
  packing::World world({A::body(0), A::body(1)}, {}, seed);
  const auto cycle = scene();
  for (std::size_t a = 0; a < arms; ++a) world.command(a, GripperCommand{{gripper_range.opening, 5, 0.1}, 1});
  world.step();
  std::array<std::unique_ptr<Mover>, arms> mover;
  for (std::size_t a = 0; a < arms; ++a)
    mover[a] = std::make_unique<Mover>(a, cycle, world.joints(a), seed * 31 + a);
  std::mt19937_64 random(seed);
  const auto in = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random); };
  const auto goal = [&](std::size_t a) {
    const double r = in(0.38, 0.72), angle = in(-0.9, 0.9);
    return Xyz<double>{side(a) * (-R::stands + r * std::cos(angle)), side(a) * r * std::sin(angle),
                       in(0.2, 0.4)};
  };
  Result pairs, things;
  std::uint64_t cycles = 0;
  for (int n = 0; n < number; ++n) {
    std::array<Xyz<double>, arms> to{goal(0), goal(1)};
    while (norm(Xyz<double>(to[0] - to[1])) < 0.3) to = {goal(0), goal(1)};
    for (std::size_t a = 0; a < arms; ++a) mover[a]->send(to[a]);
    // Straight through the space that the arms share, clear of what cannot give way: the feet and shoulders.
    const bool thing = n % 2 == 1;
    Capsule<> rod{{0, 0, 0}, {0, 0, 0}, in(0.03, 0.06)};
    Xyz<double> from{0, 0, 0}, along{0, 0, 0};
    double speed = 0, way = 0;
    if (thing) {
      for (bool free = false; !free;) {
        const double a = in(-M_PI, M_PI), up = in(-0.4, 0.4);
        along = {std::cos(up) * std::cos(a), std::cos(up) * std::sin(a), std::sin(up)};
        from = Xyz<double>{in(-0.3, 0.3), in(-0.4, 0.4), in(0.2, 0.6)} - 0.9 * along;
        const double half = in(0, 1) < 0.5 ? 0 : in(0.05, 0.25), b = in(-M_PI, M_PI), c = in(-1, 1);
        const Xyz<double> lies{half * std::sqrt(1 - c * c) * std::cos(b),
                               half * std::sqrt(1 - c * c) * std::sin(b), half * c};
        rod.from = -1.0 * lies, rod.to = lies;
        speed = in(0.1, 0.3);
        free = true;
        for (double s = 0; s < 1.8; s += 0.02) {
          const Xyz<double> p = from + s * along;
          const Capsule<> at{p + rod.from, p + rod.to, rod.radius};
          for (std::size_t k = 0; k < arms; ++k) {
            const double x = -side(k) * R::stands;
            free = free && distance(at, Capsule<>{{x, 0, 0}, {x, 0, 0.25}, 0.12}).distance > 0.25;
          }
          free = free && at.from.z > 0.1 && at.to.z > 0.1;
          if (s == 0)
            for (std::size_t k = 0; k < arms; ++k)
              for (const auto& c2 : parts(k, world.joints(k).q))
                free = free && distance(at, c2).distance > 0.25;
        }
      }
    }
    std::array<ArmRecord, arms> before{world.record(0), world.record(1)};
    const std::array<int, arms> asides{mover[0]->asides(), mover[1]->asides()};
    double nearest = 1e9, nearest_thing = 1e9, kept = 0;
    std::array<double, arms> into{-1, -1}, into_thing{-1, -1};  // the arm's own speed when it first touched
    const Nanoseconds begun = world.now();
    bool over = false;
    while (!over && world.now() - begun < 30s) {
      std::array<std::array<Capsule<>, 7>, arms> at{parts(0, world.joints(0).q), parts(1, world.joints(1).q)};
      const Xyz<double> p = from + way * along;
      const Capsule<> now_at{p + rod.from, p + rod.to, rod.radius};
      for (const auto& a : at[0])
        for (const auto& b : at[1])
          if (&a != &at[0][0] || &b != &at[1][0]) nearest = std::min(nearest, distance(a, b).distance);
      for (std::size_t a = 0; a < arms; ++a) {
        std::vector<Capsule<>> around(at[1 - a].begin(), at[1 - a].end());
        if (thing) around.push_back(now_at);
        if (thing)
          for (const auto& c : at[a]) nearest_thing = std::min(nearest_thing, distance(c, now_at).distance);
        const auto filled = mover[1 - a]->occupied();
        const auto out =
            mover[a]->step(world.joints(a), sees ? &filled : nullptr, at[a], around,
                           mover[1 - a]->waits() && (mover[a]->reached() || mover[1 - a]->gives_way()),
                           mover[1 - a]->gives_way() && mover[1 - a]->kept() && !mover[1 - a]->pressed());
        if (out.planned.valid) world.command(a, out.planned.position, out.planned.velocity);
        if (mover[a]->kept() && !mover[a]->reached()) kept += 0.008;
        ++cycles;
      }
      for (int k = 0; k < 8; ++k) {
        if (thing) {
          way += speed * 0.001;
          const Xyz<double> o = from + way * along;
          world.put_obstacle({o + rod.from, o + rod.to, rod.radius});
        }
        world.step();
        for (std::size_t a = 0; a < arms; ++a) {
          const ArmRecord& r = world.record(a);
          if (r.other_arm > before[a].other_arm && into[a] < 0) into[a] = r.into_arm;
          if (r.obstacle > before[a].obstacle && into_thing[a] < 0) into_thing[a] = r.into_obstacle;
        }
      }
      over = mover[0]->reached() && mover[1]->reached() && (!thing || way > 1.8);
    }
    world.put_obstacle({{0, 0, 0}, {0, 0, 0}, 0});
    const std::uint64_t walls =
        world.record(0).walls + world.record(1).walls - before[0].walls - before[1].walls;
    const double lasted = seconds<double>(world.now() - begun);
    const auto note = [&](Result& r, double near, bool touched, double own) {
      ++r.crossings;
      r.add(near);
      r.waited += kept > 0.2;
      r.aside += mover[0]->asides() + mover[1]->asides() > asides[0] + asides[1];
      r.stuck += !over;
      r.at_walls += walls > 0;
      r.longest = std::max(r.longest, lasted);
      r.time += lasted;
      if (!touched) return;
      ++r.met;
      r.own_fault += own > 0.02;
      r.fastest_into = std::max(r.fastest_into, own);
    };
    const auto most = [](const std::array<double, arms>& x) { return std::max({x[0], x[1], 0.0}); };
    const bool met = std::max(into[0], into[1]) >= 0, met_thing = std::max(into_thing[0], into_thing[1]) >= 0;
    note(pairs, nearest, met, most(into));
    if (thing) note(things, nearest_thing, met_thing, most(into_thing));
    if (met || met_thing || !over || walls > 0 || nearest < 0.019)
      std::printf(
          "crossing %d: %s%s%safter %.1f s (nearest %.0f mm, %.0f mm; own speed %.3f, %.3f m/s; thing %.2f "
          "m/s; table or walls %.3f s)\n",
          n, met ? "arms meet " : "", met_thing ? "thing met " : "", over ? "" : "not ended ", lasted,
          1e3 * nearest, thing ? 1e3 * nearest_thing : 0.0, most(into), most(into_thing), speed,
          1e-3 * static_cast<double>(walls));
    if (n % 50 == 49 && n + 1 < number) {
      std::printf("after %d:\n", n + 1);
      pairs.print("arm and arm"), things.print("arms and a thing");
    }
    std::fflush(stdout);
  }
  pairs.print("arm and arm");
  things.print("arms and a thing");
  std::printf("%.0f s of simulated time, %zu cells an arm, %.1f us a cycle\n", seconds<double>(world.now()),
              cycle.skin().places().size(),
              1e6 * (mover[0]->time() + mover[1]->time()) / static_cast<double>(cycles));
  return pairs.met + things.met > 0 ? 1 : 0;
}

}  // namespace
}  // namespace packing

int main(int count, char** arguments) {
  const int number = count > 1 ? std::atoi(arguments[1]) : 1000;
  const std::uint64_t seed = count > 2 ? std::strtoull(arguments[2], nullptr, 10) : 1;
  return packing::study(number, seed, count <= 3 || std::strcmp(arguments[3], "unseen") != 0);
}

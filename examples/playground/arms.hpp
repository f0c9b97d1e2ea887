// Two arms, a task and a finger around the scene of the main job.
#pragma once

#include <cstring>

#include "examples/compliant_ur5/endings.hpp"
#include "examples/compliant_ur5/following_judge.hpp"
#include "examples/compliant_ur5/scene.hpp"
#include "examples/playground/body.hpp"
#include "examples/playground/playground.hpp"
#include "skinctl/robots/ur5_skin.hpp"

namespace playground {

namespace job = compliant_ur5;

/// Where the task is.
struct TaskState {
  std::size_t next = 0;  ///< place
  double rested = 0;     ///< at the place before it [s]
  skinctl::JointPosition<6> place{};
};

/// The UR5 of the main job.
template <skinctl::Interface I, job::Sense S>
struct UrJob {
  static constexpr skinctl::Interface interface = I;
  static constexpr job::Sense sense = S;

  static auto scene(const job::Settings& s) { return job::make_watched_scene<I, S>(s); }
  static auto configuration(const job::Settings& s) { return job::configuration<I>(s); }
  static double felt_mass(const job::Settings& s) { return job::felt_mass<I, S>(s); }
  static auto cells(const job::Settings& s) { return job::simulated_cells(job::skin_patches(s)); }
  static Kinematics kinematics() { return simulated_ur5::forward_kinematics; }
  static void limit(simulated_ur5::ArmConfig&) {}
  static std::array<double, 7> tube(std::size_t i) {
    const auto& t = skinctl::ur5::tubes[std::min<std::size_t>(i, 5)];
    return {t.radius, t.from.x, t.from.y, t.from.z, t.to.x, t.to.y, t.to.z};
  }
};

/// @tparam Job  the robot, and what drives it: see `UrJob`.
template <class Job>
class ArmsBy final : public Arms {
  using Scene = decltype(std::declval<const Job&>().scene(std::declval<job::Settings>()));
  static constexpr skinctl::Interface I = Job::interface;
  static constexpr job::Sense S = Job::sense;
  static constexpr bool by_torque = I == skinctl::Interface::torque;
  static constexpr double stays = 3, moves = 5;  ///< at a place, to the next one [s]

  /// A scene, its memory and the arm that obeys it.
  struct Half {
    Half(const Job& robot, const job::Settings& s, const Choice& c, const job::PerJoint& q)
        : scene(robot.scene(s)),
          memory(std::make_unique<typename Scene::Memory>()),
          body(arm_config(robot, c, q), simulated_ur5::nanoseconds(1 / s.rate), robot.cells(s),
               skin_config(s), robot.kinematics()) {
      body.viscous = s.torque.viscous_scale;
      body.coulomb = s.torque.coulomb_scale;
      if constexpr (I == skinctl::Interface::position) {
        scene.start(*memory, body.state(), skinctl::JointPosition<6>(body.arm().target_q()));
      } else {
        scene.start(*memory, body.state());
      }
    }
    Scene scene;
    std::unique_ptr<typename Scene::Memory> memory;
    Body body;
    typename Scene::Input input;
    TaskState task;
    skinctl::WrenchSample wrench;
    skinctl::JointPosition<6> target;
    skinctl::Status status;
  };

 public:
  ArmsBy(const Job& robot, const job::Settings& s, const Choice& c, const job::PerJoint& q)
      : robot_(robot),
        settings_(s),
        ours_(robot, s, c, q),
        rigid_(robot, rigid(s), c, q),
        judge_(judge(robot, s)),
        reading_(ours_.body.cells().size()) {
    if constexpr (!by_torque) {
      felt_ = robot.felt_mass(s);
      lightest_ = felt_ / s.control.heavier_than_needed;
    }
  }

  void cycle(View& v) noexcept override {
    const Finger led = sound(finger);
    fine_ = step(ours_, led, !ended_) && fine_;
    step(rigid_, led, true);
    observe();
    const double dt = 1 / settings_.rate;
    time_ += dt;
    const double force = ours_.body.world().largest_force();
    judge_.cycle(time_, dt, ours_.memory->robot, ours_.status, force, ours_.target);
    if (!ended_) end();
    show(v);
  }

  void press(std::size_t link, const double* point, const double* normal) noexcept override {
    for (std::size_t i = 0; i < 3; ++i)
      if (!(std::abs(point[i]) < 10) || !(std::abs(normal[i]) < 10)) return;
    const Vec3 p{point[0], point[1], point[2]}, n{normal[0], normal[1], normal[2]};
    link_ = std::min<std::size_t>(link, 5), point_ = p;
    const std::size_t nearest = simulated_ur5::LedFinger::cell_at(ours_.body.cells(), link_, p, n);
    rigid_.body.begin_like(ours_.body);
    std::memcpy(static_cast<void*>(rigid_.memory.get()), ours_.memory.get(), sizeof *ours_.memory);
    rigid_.task = ours_.task;
    for (Half* half : {&ours_, &rigid_}) half->body.press(link_, p, n, nearest);
  }
  void release() noexcept override { ours_.body.release(), rigid_.body.release(); }

  void hurt(bool on) override {
    std::vector<std::pair<double, std::uint32_t>> near;
    for (const auto& c : ours_.body.cells())
      if (c.link == link_) near.emplace_back(simulated_ur5::norm(c.position - point_), c.id);
    std::sort(near.begin(), near.end());
    std::vector<std::uint32_t> silent, sticks;
    for (std::size_t k = 0; on && k < std::min(near.size(), dead + stuck); ++k)
      (k < dead ? silent : sticks).push_back(near[k].second);
    for (Half* half : {&ours_, &rigid_}) half->body.hurt(silent, sticks);
  }

  const char* words() noexcept override {
    if (ended_) return words_;
    std::size_t at = 0;
    words_[0] = 0;
    ours_.status.for_each([&](skinctl::Reason r) {
      const int n =
          std::snprintf(words_ + at, sizeof words_ - at, "%s%s", at > 0 ? "; " : "", skinctl::describe(r));
      at = std::min(sizeof words_ - 1, at + static_cast<std::size_t>(std::max(n, 0)));
    });
    return words_;
  }

  [[nodiscard]] std::array<double, 7> cell(std::size_t i) const override {
    const auto& c = ours_.body.cells().at(i);
    return {static_cast<double>(c.link),
            c.position.x,
            c.position.y,
            c.position.z,
            c.normal.x,
            c.normal.y,
            c.normal.z};
  }
  [[nodiscard]] std::array<double, 7> tube(std::size_t i) const override { return robot_.tube(i); }

 private:
  static job::Settings rigid(job::Settings s) {
    s.rigid = true;
    s.control.heavier_than_needed = 1;
    return s;
  }
  static auto judge(const Job& robot, const job::Settings& s) {
    if constexpr (by_torque) {
      return job::StandingJudge<6>(skinctl::JointTorque<6>(s.torque.most_friction));
    } else {
      return job::FollowingJudge<6>(robot.configuration(s));
    }
  }
  static simulated_ur5::ArmConfig arm_config(const Job& robot, const Choice& c, const job::PerJoint& q) {
    simulated_ur5::ArmConfig arm;
    arm.delay = 1e-3 * c.delay;
    arm.lag = 1e-3 * c.real_lag;
    arm.home = q;
    robot.limit(arm);
    return arm;
  }
  static simulated_ur5::SkinConfig skin_config(const job::Settings& s) {
    simulated_ur5::SkinConfig skin;
    skin.newtons_per_reading = s.newtons_per_reading;
    skin.rest_reading = s.rest_reading;
    skin.force_delta = s.force_delta;
    return skin;
  }

  /// Numbers from a page, within what a finger can be.
  static Finger sound(const Finger& f) noexcept {
    const auto in = [](double x, double low, double high, double otherwise) {
      return x >= low && x <= high ? x : otherwise;
    };
    return {in(f.stiffness, 10, 1e5, 3000),
            in(f.travel, 0, 200, 0),
            {in(f.aside[0], -1, 1, 0), in(f.aside[1], -1, 1, 0), in(f.aside[2], -1, 1, 0)}};
  }
  /// One cycle of one arm; false: its controller stopped it.
  bool step(Half& h, const Finger& led, bool goes) noexcept {
    const bool fine = h.body.step(led);
    auto& in = h.input;
    in.measured = h.body.state();
    in.now = in.measured.time;
    in.goal.reset();
    in.request = goes ? skinctl::CycleRequest::none : skinctl::CycleRequest::stop;
    if constexpr (S == job::Sense::skin) in.samples = h.body.samples();
    if constexpr (S == job::Sense::wrist) h.wrench = h.body.wrench(), in.sensed.wrenches = {&h.wrench, 1};
    if constexpr (S == job::Sense::motors) in.sensed.motor_torque = h.body.motor_torque();
    task(h);
    const auto out = h.scene.step(*h.memory, in);
    h.status = out.status;
    const auto& reach = std::get<0>(h.scene.law().sum().laws());
    h.target = reach.reference(Scene::law_type::template memory<0>(h.memory->law)).q_d;
    if (out.command.valid) h.body.send(out.command);
    return fine;
  }
  /// Another place once the plan has been at the last one for a while.
  void task(Half& h) noexcept {
    TaskState& t = h.task;
    if (time_ == 0) t.place = h.target = h.input.measured.q;
    double off = 0;
    for (std::size_t i = 0; i < 6; ++i) off = std::max(off, std::abs(h.target[i] - t.place[i]));
    t.rested = off < 1e-3 ? t.rested + 1 / settings_.rate : 0;
    if (t.rested < stays) return;
    t.rested = 0;
    t.place = skinctl::JointPosition<6>(settings_.task[t.next].q);
    t.next = (t.next + 1) % settings_.task.size();
    h.input.goal = typename Scene::Goal{.goal = skinctl::JointGoal<6>{t.place, skinctl::nanoseconds(moves)}};
  }
  /// The newest reading of each cell.
  void observe() noexcept {
    for (const auto& s : ours_.body.samples())
      if (s.cell >= 1 && s.cell <= reading_.size())
        reading_[s.cell - 1] =
            settings_.newtons_per_reading *
            (static_cast<double>(s.force[0] + s.force[1] + s.force[2]) - 3 * settings_.rest_reading);
  }
  void end() noexcept {
    using job::Ending;
    Ending why = Ending::finished;
    if (!fine_)
      why = Ending::displaced;
    else if (judge_.stuck_joint() != 0)
      why = Ending::stuck;
    else if (judge_.late())
      why = Ending::late;
    else if (ours_.status.has(skinctl::Reason::skin_stopped))
      why = Ending::skin_deaf;
    if (why == Ending::finished) return;
    ended_ = true;
    const auto& row = job::row(why);
    if (why == Ending::displaced) {
      std::snprintf(words_, sizeof words_, "stopped: the robot's controller made a protective stop");
    } else if (why == Ending::late) {
      std::snprintf(words_, sizeof words_, "stopped: %s: by %.0f ms", row.words,
                    1e3 * judge_.following().lag);
    } else {
      std::snprintf(words_, sizeof words_, "stopped: %s", row.words);
    }
  }

  static void poses(const simulated_ur5::Links& links, double (&out)[6][12]) noexcept {
    for (std::size_t i = 0; i < 6; ++i) {
      const auto& X = links.link[i];
      std::size_t k = 0;
      for (const Vec3 c : {X.x, X.y, X.z, X.origin})
        out[i][k] = c.x, out[i][k + 1] = c.y, out[i][k + 2] = c.z, k += 3;
    }
  }
  void show(View& v) const noexcept {
    const auto& world = ours_.body.world();
    const auto &touch = world.results()[0], &stiff = rigid_.body.world().results()[0];
    v.time = time_, v.period = 1 / settings_.rate;
    v.force = world.largest_force(), v.rigid_force = rigid_.body.world().largest_force();
    v.peak = touch.peak_force, v.rigid_peak = stiff.peak_force;
    v.gave_way = 1e3 * touch.peak_deflection, v.rigid_gave_way = 1e3 * stiff.peak_deflection;
    v.places = static_cast<double>(settings_.task.size());
    v.place = static_cast<double>((ours_.task.next + settings_.task.size() - 1) % settings_.task.size() + 1);
    v.resting = ours_.task.rested > 0 ? 1 : 0;
    v.touching = ours_.body.finger().present() ? 1 : 0, v.ended = ended_ ? 1 : 0;
    v.felt_mass = felt_, v.lightest = lightest_;
    v.away = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      v.q[i] = ours_.body.arm().q()[i], v.target[i] = ours_.target[i],
      v.rigid_q[i] = rigid_.body.arm().q()[i];
      v.away = std::max(v.away, std::abs(v.q[i] - v.target[i]));
    }
    poses(ours_.body.links(), v.links), poses(rigid_.body.links(), v.rigid_links);
    const auto [tip, direction] = world.finger(0);
    v.tip[0] = tip.x, v.tip[1] = tip.y, v.tip[2] = tip.z;
    v.direction[0] = direction.x, v.direction[1] = direction.y, v.direction[2] = direction.z;
    v.cells = v.usable = static_cast<double>(reading_.size());
    for (std::size_t i = 0; i < reading_.size(); ++i) {
      v.reading[i] = reading_[i];
      v.mask[i] = 0;
      if constexpr (S == job::Sense::skin) {
        const auto& skin = ours_.scene.skin();
        const auto& m = ours_.memory->skin;
        v.mask[i] = skin.faults(m, i).has(skinctl::CellFault::unheard) || skin.mask(m, i) > 0.5f ? 1 : 0;
        v.usable -= v.mask[i];
      }
    }
  }

  Job robot_;
  job::Settings settings_;
  Half ours_, rigid_;
  decltype(judge(std::declval<Job>(), std::declval<job::Settings>())) judge_;
  std::vector<double> reading_;
  std::size_t link_ = 2;
  Vec3 point_{-0.2, 0, 0.05};
  double time_ = 0, felt_ = 0, lightest_ = 0;
  bool fine_ = true, ended_ = false;
  char words_[1024] = {};
};

}  // namespace playground

// The run, for an arm `R`.
#pragma once

#include <chrono>
#include <cmath>

#include "examples/packing_oranges/carriage.hpp"
#include "examples/packing_oranges/hand.hpp"
#include "examples/packing_oranges/mover.hpp"
#include "examples/packing_oranges/obstacle.hpp"
#include "examples/packing_oranges/run.hpp"
#include "examples/packing_oranges/worker.hpp"

namespace packing {

/// The skin of a forearm, and the person who pushes it: a force on one cell.
template <class R>
class Toucher {
 public:
  Toucher(const RunSettings& s, std::size_t all, std::uint64_t seed)
      : s_(s), graph_(Arm<R>::skin().graph()), cells_(Arm<R>::cells()), random_(seed) {
    for (std::size_t i = 0; i < all; ++i)
      if (!is_dead(i)) samples_.push_back({.cell = static_cast<std::uint32_t>(i + 1)});
  }
  /// From now on `force` newtons along the inward normal of a cell, 0: none.
  void push(World& world, std::size_t arm, double force) {
    if (force > 0 && !(force_ > 0)) cell_ = random_() % cells_.size();
    force_ = force;
    const auto& X = cells_[cell_].X_LC;
    world.push(arm, forearm, X.origin(), -force * X.axis_z());
  }
  /// What else presses on the forearm, for the next samples: each contact as the person's, on the nearest
  /// cell.
  void feel(std::span<const World::Contact> contacts) {
    pressed_.assign(cells_.size(), 0);
    for (const World::Contact& c : contacts) {
      std::size_t nearest = 0;
      for (std::size_t i = 1; i < cells_.size(); ++i)
        if (far(c, i) < far(c, nearest)) nearest = i;
      const double f = std::max(0.0, -dot(c.force, cells_[nearest].X_LC.axis_z()));
      for (std::size_t i = 0; i < cells_.size(); ++i)
        pressed_[i] += f * (i == nearest ? 1 : graph_.joined(nearest, i) ? spread : 0);
    }
  }
  /// Of all cells that are heard; `near`: what all see, nothing where it is empty.
  [[nodiscard]] std::span<skinctl::CellSample> samples(skinctl::Nanoseconds now,
                                                       std::span<const double> near = {}) {
    for (skinctl::CellSample& x : samples_) {
      const std::size_t i = x.cell - 1;
      x.time = now;
      x.proximity = i < near.size() ? static_cast<float>(near[i]) : 0.0f;
      if (i >= cells_.size()) continue;
      const double share = i == cell_ ? 1 : graph_.joined(cell_, i) ? spread : 0;
      const double others = pressed_.empty() ? 0 : pressed_[i];
      const double f = share * force_ + others + s_.skin_noise * normal_(random_);
      const auto reading = static_cast<float>(std::clamp(f / (3 * newtons_per_reading), 0.0, 1.0));
      x.force = {reading, reading, reading};
    }
    return samples_;
  }
  [[nodiscard]] double force() const { return force_; }

 private:
  [[nodiscard]] double far(const World::Contact& c, std::size_t i) const {
    return norm(skinctl::Xyz<double>(c.at - cells_[i].X_LC.origin()));
  }
  /// Whether cell `i` says nothing any more: so many of the forearm's, evenly.
  [[nodiscard]] bool is_dead(std::size_t i) const {
    const std::size_t dead = s_.dead_cells;
    return i < cells_.size() && (i + 1) * dead / cells_.size() > i * dead / cells_.size();
  }

  RunSettings s_;
  skinctl::CellGraph graph_;
  std::vector<skinctl::PlacedCell<forearm>> cells_;
  std::vector<skinctl::CellSample> samples_;
  std::vector<double> pressed_;  ///< forces of other contacts on the cells of the forearm [N]
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::size_t cell_ = 0;
  double force_ = 0;
};

template <class R>
class Run {
 public:
  using A = Arm<R>;

  explicit Run(const RunSettings& s)
      : s_(s),
        world_(bodies(s), worlds(s), s.seed * 7919 + 1),
        supply_(supplies(s), s.seed * 7919 + 2),
        detector_(detectors(s), s.seed * 7919 + 3),
        box_(60s),
        places_(box_.start()),
        person_(s.seed * 7919 + 11) {
    world_.step();
    const auto skin = A::skin();
    for (std::size_t a = 0; a < arms; ++a) {
      WorkSettings work = s.hand[a] ? by_hand(s.work) : s.work;
      work.honest = s.honest;
      work.stay = s.honest && s.stay;
      work.drives = drives(s.work.plan);
      work.full_box = static_cast<std::size_t>(s.supply.full_box);
      workers_.push_back(std::make_unique<Worker<R>>(a, work, world_.joints(a)));
      if (s.hand[a]) hands_[a] = std::make_unique<Hand>(around_a_ball(), world_.fingers(a));
      touchers_.push_back(std::make_unique<Toucher<R>>(s, skin.places().size(), s.seed * 7919 + 4 + a));
      next_touch_[a] = s.touch_every * (a == 0 ? 0.4 : 0.9);
      if (s.obstacle > 0) eyes_.emplace_back(skin.places(), s.seed * 7919 + 9 + a);
    }
    if (worlds(s).drives) carriage_.emplace(world_.wheels());
    if (uses_tool(s.work.plan)) {
      kitchen_.emplace(tool_lesson(s.work.plan, s.work.ways, R::stands), s.move_box, s.seed * 7919 + 14);
      kitchen_->lay(world_);
    } else if (s.move_box > 0) {
      mover_.emplace(s.move_box, s.seed * 7919 + 10);
    }
    if (s.obstacle > 0) passer_.emplace(s.obstacle, s.seed * 7919 + 8);
    lasts_ = s.fault_lasts > 0 ? s.fault_lasts : duration(s.fault);
  }

  Outcome operator()(const Watch& watch, const Show& show) {
    const double longest = s_.longest > 0 ? s_.longest : 60 + 20.0 * s_.supply.oranges;
    const std::clock_t begun = std::clock();
    while (time() < longest + waits_for_person_) {
      if (tick_ % 100 == 0 && watch && !watch(time(), supply_)) {
        out_.stopped = true;
        break;
      }
      if (tick_ % 8 == 0) {
        if (show && tick_ % 32 == 0) {
          const skinctl::CycleRequest asked = show(scenery());
          if (asked != skinctl::CycleRequest::none)
            for (auto& w : workers_) w->request(asked);
        }
        if (kitchen_)
          kitchen_->step(world_);
        else
          supply_.step(world_);
        happen();
        cycle();
        const bool finished = is_out(0) && is_out(1);
        if (!finished) works_at_ = time();
        const bool leaves = s_.honest || workers_[0]->gives_up() || workers_[1]->gives_up();
        if (finished && (supply_.over() || (leaves && time() - works_at_ > 4))) {
          out_.over = true;
          break;
        }
      }
      if (tick_ % 3 == 0) hold();
      if (passer_) pass();
      if (mover_) out_.box_moved = mover_->step(world_);
      world_.step();
      ++tick_;
    }
    return collect(static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC);
  }

 private:
  /// Masses of a hand that differ from those that its cycle knows by up to a tenth.
  static void weigh_anew(HandBody& hand, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> share(0.9, 1.1);
    const auto scale = [&](LinkBody& l) {
      const double by = share(random);
      l.mass *= by;
      for (double& x : l.inertia) x *= by;
    };
    for (LinkBody& l : hand.links) scale(l);
    scale(hand.palm);
  }
  [[nodiscard]] static std::array<ArmBody, arms> bodies(const RunSettings& s) {
    std::array<ArmBody, arms> out{A::body(0), A::body(1)};
    for (std::size_t a = 0; a < arms; ++a) {
      if (!s.hand[a]) continue;
      out[a].hand = hand_body(around_a_ball(), out[a].flange, reach_of_gripper);
      out[a].hand->takes_part = around_a_ball().takes_part;
      if (s.honest) weigh_anew(*out[a].hand, s.seed * 7919 + 12 + a);
      out[a].home = {0.6, -1.6, 1.8, -1.77, -1.57, 0.6};  // over its bin: a hand is wider than a gripper
    }
    return out;
  }
  [[nodiscard]] static WorldSettings worlds(const RunSettings& s) {
    WorldSettings out = s.world;
    out.trays_move = s.honest || s.move_box > 0;
    out.drives = drives(s.work.plan);
    out.kitchen = uses_tool(s.work.plan);
    if (s.honest && s.stay) out.room = slots, out.opens_gently = out.loads_trays = true;
    return out;
  }
  [[nodiscard]] static SupplySettings supplies(const RunSettings& s) {
    SupplySettings out = s.supply;
    out.stay = s.honest && s.stay;
    out.boxes_come = puts_boxes_away(s.work.plan);
    out.waits = s.obstacle > 0;  // an arm that gives way comes back to where it takes an orange
    return out;
  }
  [[nodiscard]] static DetectorSettings detectors(const RunSettings& s) {
    DetectorSettings out = s.detector;
    out.numbers = !s.honest;
    return out;
  }
  [[nodiscard]] double time() const { return skinctl::seconds<double>(world_.now()); }
  [[nodiscard]] bool faulty(Fault f) const {
    return s_.fault == f && time() >= s_.fault_at && time() < s_.fault_at + lasts_;
  }

  [[nodiscard]] skinctl::GripperState gripper(std::size_t a) const {
    return hands_[a] ? hands_[a]->state() : world_.gripper(a);
  }
  /// Touches and faults.
  void happen() {
    const double t = time();
    if (s_.fault_step >= 0) {
      const auto& done = workers_[0]->done();
      s_.fault_at = 1e9;
      if (!done.empty() && done.back().step == s_.fault_step) s_.fault_at = t, s_.fault_step = -1;
    }
    for (std::size_t a = 0; a < arms; ++a) {
      ArmOutcome& o = out_.arm[a];
      if (s_.touch_every > 0 && t >= next_touch_[a]) {
        touch_until_[a] = t + s_.touch_lasts;
        next_touch_[a] += s_.touch_every;
        ++o.touches;
      }
      const bool held = a == 0 && faulty(Fault::touch_held);
      const bool on = t < touch_until_[a] || held;
      if (on != (touchers_[a]->force() > 0)) touchers_[a]->push(world_, a, on ? s_.touch_force : 0);
    }
    detector_.step(world_, faulty(Fault::no_detector), carriage_ ? &carriage_->state() : nullptr);
    if (s_.fault == Fault::slip && slipped_ < 0 && t >= s_.fault_at)
      for (std::size_t k = 0; k < slots; ++k)
        if (workers_[0]->carries() && world_.there(k) && world_.now() - world_.touched(k) < 5ms &&
            world_.touched(k) >= skinctl::Nanoseconds(0)) {
          world_.make_slippery(k);
          slipped_ = static_cast<int>(k);
          out_.fault_begins = t;
          out_.fault_ends = t + lasts_;
        }
    if (s_.fault == Fault::box_held) hold_box();
    if (slipped_ >= 0 && !dry_ && t >= out_.fault_ends) {
      world_.make_slippery(static_cast<std::size_t>(slipped_), false);
      dry_ = true;
    }
  }

  /// A person takes hold of the first full box that an arm moves, and pulls it aside; an arm's strength at most.
  void hold_box() {
    constexpr double aside = 0.08, stiffness = 2000, damping = 90, strength = 60;
    const Tray box = world_.tray(0);
    const double t = time();
    if (out_.fault_begins == 0 && (workers_[0]->moves_box() || workers_[1]->moves_box()) &&
        norm(world_.tray_velocity(0)) > 0.05)
      out_.fault_begins = t, out_.fault_ends = t + lasts_, held_at_ = {box.x, box.y + aside, 0};
    const bool on = out_.fault_begins > 0 && t < out_.fault_ends;
    skinctl::Xyz<double> force =
        stiffness * skinctl::Xyz<double>(held_at_ - skinctl::Xyz<double>{box.x, box.y, 0}) -
        damping * world_.tray_velocity(0);
    force = std::min(1.0, strength / std::max(norm(force), 1e-9)) * force;
    world_.pull_tray(0, on ? force : skinctl::Xyz<double>{0, 0, 0});
  }
  /// A millisecond of the thing that moves through the room.
  void pass() {
    if (tick_ % 8 == 0) {
      for (std::size_t a = 0; a < arms; ++a) shapes_[a] = A::shapes_at(A::link_places(a, world_.joints(a).q));
      if (obstacle_.radius > 0)
        for (const auto& shapes : shapes_)
          for (const auto& c : shapes) out_.nearest = std::min(out_.nearest, distance(c, obstacle_).distance);
    }
    std::vector<skinctl::Capsule<>> all = shapes_[0];
    all.insert(all.end(), shapes_[1].begin(), shapes_[1].end());
    obstacle_ = passer_->step(0.001, R::stands, all);
    world_.put_obstacle(obstacle_);
  }
  /// What the skin of an arm sees: the other arm, and what moves through the room.
  [[nodiscard]] std::span<const double> look(std::size_t a) {
    std::vector<skinctl::Capsule<>> around = shapes_[1 - a];
    if (obstacle_.radius > 0) around.push_back(obstacle_);
    return eyes_[a].look(A::link_places(a, world_.joints(a).q), around);
  }
  void cycle() {
    Picture picture;
    for (std::size_t a = 0; a < arms; ++a) {
      if (s_.see_each_other) workers_[a]->other_hand(workers_[1 - a]->hand().origin());
      workers_[a]->hear_of_camera(workers_[1 - a]->believed());
    }
    while (detector_.take(world_.now(), picture)) {
      if (carriage_) carriage_->see(picture.base, picture.things);
      for (auto& w : workers_) w->see(picture);
    }
    if (carriage_) roll();
    std::array<skinctl::PlaceRequest, arms + 1> asked{};
    for (std::size_t a = 0; a < arms; ++a) asked[a] = workers_[a]->place_request();
    const bool person = faulty(Fault::box_blocked);
    asked[arms] = {.wants = person ? std::uint8_t(0) : std::uint8_t(255), .leaves = 1};
    const auto places = box_.step(places_, world_.now(), asked);
    places_ = places.memory;
    const std::clock_t begun = std::clock();
    if (faulty(Fault::arm_stopped)) workers_[0]->request(skinctl::CycleRequest::stop);
    for (std::size_t a = 0; a < arms; ++a) {
      Worker<R>& w = *workers_[a];
      w.other_is_out(s_.honest && !workers_[1 - a]->finished() && is_out(1 - a));
      if (s_.honest) touchers_[a]->feel(world_.take_contacts(a, forearm));
      const bool resume = w.asks() && answers(a);
      w.goes_first(places_.holder[0] == a || (places_.holder[0] != 1 - a && a == 0));
      w.other_waits(workers_[1 - a]->waits());
      w.other_presses(workers_[1 - a]->presses());
      if (s_.see_each_other)
        w.keep_clear_of(world_.now(), workers_[1 - a]->occupied());
      else
        w.keep_clear_of(world_.now(), skinctl::Surroundings<1, skinctl::World>{});
      const bool sees = passer_ && s_.see_each_other;
      const auto samples = touchers_[a]->samples(world_.now(), sees ? look(a) : std::span<const double>{});
      if (sees) w.look_around(world_.joints(a), samples);
      if (s_.world.binary) w.feel(world_.wrist(a));
      if (hands_[a]) w.feel_between(hands_[a]->between());
      const auto out =
          w.step(world_.now(), world_.joints(a), gripper(a), samples, places.grants[a].granted, resume);
      if (out.command.valid) world_.command(a, out.command.position, out.planned.velocity);
      if (hands_[a])
        asked_of_hand_[a] = out.gripper;
      else
        world_.command(a, out.gripper);
      watch(a, w, places.grants[a].granted);
    }
    computed_ += static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
    ++cycles_;
  }
  /// A cycle of the base: it drives where both arms want to, or one, while the other has finished.
  void roll() {
    Carriage& base = *carriage_;
    const auto wants = [&](std::size_t a) { return workers_[a]->wants_to_drive(); };
    std::size_t to = Carriage::nowhere;
    for (std::size_t a = 0; a < arms; ++a) {
      const bool other_agrees = workers_[1 - a]->finished() || wants(1 - a) == wants(a);
      if (wants(a) != Carriage::nowhere && other_agrees) to = wants(a);
    }
    if (to != Carriage::nowhere && base.table() != Carriage::nowhere) base.go(to);
    const bool touched = workers_[0]->is_touched() || workers_[1]->is_touched();
    world_.drive(base.step(world_.now(), world_.wheels(), touched));
    for (auto& w : workers_) w->stands(base.state(), base.table());
    if (base.table() == Carriage::nowhere) return;
    const auto off =
        base.state().X_WB.inverse() * world_.robot().pose().renamed<skinctl::World, skinctl::Tool>();
    out_.stood_off = std::max(out_.stood_off, norm(off.origin()));
    out_.stood_turned = std::max(out_.stood_turned, std::abs(off.axis_x().y));
  }
  /// A cycle of the hands. How they stand to gravity is told by the arms' joints.
  void hold() {
    const std::clock_t begun = std::clock();
    for (std::size_t a = 0; a < arms; ++a) {
      if (!hands_[a]) continue;
      const auto& X = workers_[a]->hand();
      Hand::Input in;
      in.measured = world_.fingers(a);
      in.tips = world_.tips(a);
      in.gravity = gravity_in_hand(X);
      in.command = asked_of_hand_[a];
      world_.command(a, hands_[a]->step(in));
      ++holds_;
    }
    held_ += static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC;
  }
  /// Whether the first arm is stopped for good: no person sets it right.
  [[nodiscard]] bool is_stopped(std::size_t a) const {
    return a == 0 && s_.fault == Fault::arm_stopped && time() >= s_.fault_at;
  }
  /// Whether an arm has finished, or is stopped and has asked for a while.
  [[nodiscard]] bool is_out(std::size_t a) const {
    constexpr double patience = 10;  // [s]
    return workers_[a]->finished() || (kitchen_ && workers_[a]->gives_up()) ||
           (is_stopped(a) && asked_since_[a] >= 0 && time() > asked_since_[a] + patience);
  }
  /// A person who is asked comes when the fault is over, and takes a while; in an ideal world a second. Where
  /// nobody comes an arm goes on by itself, as long as it does not give up.
  bool answers(std::size_t a) {
    constexpr double goes_on_after = 20;  // [s]
    if (asked_since_[a] < 0) {
      asked_since_[a] = time();
      ++out_.arm[a].asked;
      std::uniform_real_distribution<double> after(s_.answers_after, s_.answers_within);
      comes_after_[a] = !s_.answers ? goes_on_after : s_.honest ? after(person_) : 1;
      if (s_.honest && !is_stopped(a)) waits_for_person_ += comes_after_[a];
    }
    if (is_stopped(a)) return false;
    const bool passed = s_.fault == Fault::arm_stopped || time() >= s_.fault_at + lasts_;
    const bool over = passed && time() > asked_since_[a] + comes_after_[a];
    if (over) asked_since_[a] = -1;
    if (over && kitchen_) kitchen_->bring(world_, a);
    return over;
  }
  /// What the judges note.
  void watch(std::size_t a, const Worker<R>& w, bool granted) {
    ArmOutcome& o = out_.arm[a];
    const double t = time();
    const ArmRecord& r = world_.record(a);
    if (w.carries() && !(touchers_[a]->force() > 0)) square_[a] += r.square, samples_[a] += r.samples;
    world_.clear_shake(a);
    world_.moves_trays(a, w.grips_box());
    if (!granted || w.waits_for_room()) o.waited += 0.008;
    while (o.judged.size() < w.judged().size()) {
      const auto& j = w.judged()[o.judged.size()];
      const std::size_t k = in_hand(a);
      o.judged.push_back({j.stiffness, supply_.stiffness(k), j.time, j.good, supply_.good(k)});
    }
    if (s_.keep_path && cycles_ % 4 == 0) {
      const auto p = world_.hand(a);
      o.path.push_back({t, p.x, p.y, p.z, r.force, gripper(a).opening, touchers_[a]->force() > 0});
    }
  }
  /// The orange between the fingers: the nearest one.
  [[nodiscard]] std::size_t in_hand(std::size_t a) const {
    std::size_t best = 0;
    double least = 1e9;
    for (std::size_t k = 0; k < arms * slots; ++k) {
      const double far = norm(skinctl::Xyz<double>(world_.orange(k) - world_.hand(a)));
      if (world_.there(k) && far < least) best = k, least = far;
    }
    return best;
  }
  /// Shapes of the robot, where it stands.
  template <class Shapes>
  [[nodiscard]] Shapes in_world(Shapes shapes) const {
    const auto X = world_.robot().pose();
    for (skinctl::Capsule<>& c : shapes) {
      c.from = X.origin() + X.axes() * c.from;
      c.to = X.origin() + X.axes() * c.to;
    }
    return shapes;
  }
  [[nodiscard]] Scenery scenery() const {
    Scenery out;
    if (carriage_) out.robot_stands = world_.robot();
    out.time = time();
    out.robot = R::name;
    out.all = s_.supply.oranges;
    for (const Packed& p : supply_.ended())
      ++(p.end == Packed::End::box ? out.box : p.end == Packed::End::bin ? out.bins : out.lost);
    for (std::size_t k = 0; k < arms * slots; ++k)
      if (world_.there(k)) out.oranges.push_back({world_.orange(k)});
    for (std::size_t k = 0; k < tray_count; ++k) out.trays[k] = world_.tray(k);
    if (obstacle_.radius > 0) out.things.push_back({obstacle_.from, obstacle_.radius});
    for (std::size_t a = 0; a < arms; ++a) {
      const Worker<R>& w = *workers_[a];
      ArmScenery& arm = out.arm[a];
      arm.parts = in_world(A::parts(a, world_.joints(a).q));
      arm.fingers = in_world(A::fingers(a, world_.joints(a).q, gripper(a).opening));
      arm.force = world_.record(a).force;
      arm.touched = touchers_[a]->force() > 0;
      arm.kept = w.kept();
      arm.has_box = places_.holder[0] == a;
      arm.step = w.finished() || w.done().empty() ? "" : name_of(s_.work.plan, w.done().back().step);
      arm.state = w.finished() ? "finished" : w.asks() ? "asks" : w.goes_back() ? "goes back" : "";
      if (!w.judged().empty())
        arm.stiffness = w.judged().back().stiffness, arm.said_good = w.judged().back().good;
    }
    return out;
  }
  Outcome collect(double computed) {
    out_.ended = supply_.ended();
    out_.oranges = s_.supply.oranges;
    out_.put_away = supply_.put_away();
    for (std::size_t a = 0; a < arms && kitchen_; ++a) out_.tool[a] = kitchen_->judge(world_, a);
    out_.fetched = supply_.fetched();
    if (passer_) out_.passes = passer_->passes();
    if (carriage_) {
      const Standing at = world_.robot();
      const auto told = world_.wheels().q;
      out_.wheels_off = {at.x - told[0], at.y - told[1], at.yaw - told[2]};
      out_.drives = carriage_->drives(), out_.halts = carriage_->halts();
      out_.corrections = carriage_->corrections();
    }
    out_.time = time();
    out_.computed = computed;
    out_.cycle = cycles_ > 0 ? 1e6 * computed_ / static_cast<double>(arms * cycles_) : 0;
    out_.hand_cycle = holds_ > 0 ? 1e6 * held_ / static_cast<double>(holds_) : 0;
    out_.robot = R::name;
    if (s_.hand[0] && s_.hand[1])
      out_.robot += " with Allegro hands";
    else if (s_.hand[0] || s_.hand[1])
      out_.robot += ", one with an Allegro hand";
    if (s_.fault != Fault::none && s_.fault != Fault::slip && s_.fault != Fault::box_held)
      out_.fault_begins = s_.fault_at, out_.fault_ends = s_.fault_at + lasts_;
    for (std::size_t a = 0; a < arms; ++a) {
      ArmOutcome& o = out_.arm[a];
      o.done = workers_[a]->done();
      o.worst_grip = world_.record(a).worst_grip;
      o.worst_press = world_.record(a).worst_press;
      o.worst_force = world_.record(a).worst_force;
      o.shake = samples_[a] > 0 ? std::sqrt(square_[a] / static_cast<double>(samples_[a])) : 0;
      o.other_arm = world_.record(a).other_arm;
      o.walls = world_.record(a).walls;
      o.longest_at_wall = world_.record(a).longest_at_wall;
      o.wall_force = world_.record(a).wall_force;
      o.worst_push = world_.record(a).worst_push;
      o.went_aside = workers_[a]->went_aside();
      o.obstacle = world_.record(a).obstacle;
      o.into_obstacle = world_.record(a).into_obstacle;
      o.gave_way = workers_[a]->gave_way();
      o.set_right = workers_[a]->set_right();
      const Believed& believed = workers_[a]->believed();
      o.empty_takes = believed.failures();
      o.gave_up = workers_[a]->gives_up();
      o.hold = workers_[a]->hold();
      o.slipped = believed.left();
      o.doubted = believed.doubted(feed_tray(a));
      o.bias = believed.bias();
      for (const Packed& p : out_.ended)
        if (p.arm == a) o.busy = std::max(o.busy, p.time);
    }
    return std::move(out_);
  }

  RunSettings s_;
  World world_;
  Supply supply_;
  Detector detector_;
  skinctl::Resources<1, arms + 1> box_;
  typename skinctl::Resources<1, arms + 1>::Memory places_;
  std::vector<std::unique_ptr<Worker<R>>> workers_;
  std::array<std::unique_ptr<Hand>, arms> hands_;
  std::array<skinctl::GripperCommand, arms> asked_of_hand_{};
  std::vector<std::unique_ptr<Toucher<R>>> touchers_;
  std::array<double, arms> next_touch_{}, touch_until_{}, square_{}, asked_since_{-1, -1}, comes_after_{};
  std::mt19937_64 person_;       ///< who is asked
  double waits_for_person_ = 0;  ///< in all [s]
  std::array<std::uint64_t, arms> samples_{};
  std::optional<Passer> passer_;
  std::optional<BoxMover> mover_;
  std::optional<Kitchen> kitchen_;
  std::optional<Carriage> carriage_;
  std::vector<Eyes> eyes_;
  std::array<std::vector<skinctl::Capsule<>>, arms> shapes_;
  skinctl::Capsule<> obstacle_{{0, 0, 0}, {0, 0, 0}, 0};
  Outcome out_;
  double lasts_ = 0, computed_ = 0, held_ = 0, works_at_ = 0;
  std::uint64_t tick_ = 0, cycles_ = 0, holds_ = 0;
  skinctl::Xyz<double> held_at_{0, 0, 0};  ///< where a person holds the box
  int slipped_ = -1;                       ///< the orange
  bool dry_ = false;
};

}  // namespace packing

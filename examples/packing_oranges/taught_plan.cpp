#include "examples/packing_oranges/taught_plan.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "examples/packing_oranges/tomm.hpp"
#include "examples/packing_oranges/tool.hpp"
#include "examples/support/text.hpp"

namespace packing {
namespace {
using namespace skinctl;
using examples::text;
static_assert(teach::Task::capacity == Plan::capacity);

/// Whether there is a skill for it.
bool is_done_by_tomm(const ActivityRule* does) {
  return boost::hana::unpack(boost::hana::keys(tomm), [&](auto... activity) {
    return ((does == &decltype(activity)::type::rule) || ...);
  });
}

class Reader {
 public:
  Reader(const teach::NamedTask& task, const HandRoom& room)
      : classes_(task.classes),
        ways_(task.ways),
        room_(room),
        plan_(task.task),
        uses_tool_(uses_tool(plan_)) {}

  Plan plan() {
    for (std::uint8_t k = 0; k < plan_.size; ++k) understand(k);
    for (std::size_t i = 0; i < plan_.place_count; ++i) {
      plan_.places[i].mark = class_here(plan_.places[i].mark);
      // The hand goes beside every orange as at the first such place, whichever step names it.
      if (!uses_tool_ && plan_.places[i].mark == orange_class)
        around_orange(0, orange_class, plan_.places[i].X_MH.origin());
    }
    go_back_after_releases();
    plan_.name = "taught";
    if (const TaskFault fault = check(plan_); fault.any()) refuse(fault.step, describe(fault.error));
    return plan_;
  }

 private:
  [[noreturn]] void refuse(std::uint8_t step, const std::string& why) const {
    const ActivityRule* does = plan_.steps[step].does;
    throw std::runtime_error(text("step %d of the task (%s): ", int(step), does ? does->name : "?") + why);
  }
  [[nodiscard]] ObjectClass class_here(ObjectClass kind) const {
    const std::string name = kind == 0 ? "" : classes_.name(kind);
    if (uses_tool_)
      return name == "bread"   ? orange_class
             : name == "plate" ? bin_class
             : name == "knife" ? tool_class
                               : ObjectClass(0);
    return name == "orange"     ? orange_class
           : name == "box"      ? box_class
           : name == "bin"      ? bin_class
           : name == "full box" ? full_box_class
           : name == "shelf"    ? shelf_class
                                : ObjectClass(0);
  }
  /// Whether these arms can do a step; its role becomes the class that it has here.
  void understand(std::uint8_t k) {
    Step& s = plan_.steps[k];
    const ObjectClass role = class_here(s.role);
    if (uses_tool_) return understand_with_tool(k, role);
    if (role != orange_class && role != full_box_class)
      refuse(k, "here are oranges, a box and bins, no " + classes_.name(s.role));
    s.role = role;
    if (!is_done_by_tomm(s.does)) refuse(k, "these arms have no skill for it");
    if (s.does == &activity::Look::rule && s.no == ask_person)
      refuse(k, "it is done once; show it with more than one orange, and it goes on until none is left");
    if (role == full_box_class) return understand_box(k);
    const bool goes =
        s.does == &activity::Put::rule || s.does == &activity::Carry::rule || s.does == &FindRoom::rule;
    if (s.place == no_place && goes) refuse(k, "it has no place");
    if (s.place == no_place) return;
    TaughtPlace& place = plan_.places[s.place];
    const ObjectClass mark = class_here(place.mark);
    if (mark == 0 && place.mark != 0)
      refuse(k, "its place is beside a " + classes_.name(place.mark) + ", and there is none here");
    const auto& p = place.X_MH.origin();
    if (s.does == &FindRoom::rule && mark != box_class) refuse(k, "it is the box that is to have room");
    const bool lets_go = s.does == &activity::Put::rule || s.does == &FindRoom::rule ||
                         s.does == &activity::Find::rule || s.does == &activity::Release::rule;
    if (lets_go)
      in_tray(k, mark, place);
    else if (s.does == &activity::Carry::rule || s.does == &activity::Squeeze::rule)
      in_room(k, mark, p);
    else
      around_orange(k, mark, p);
    // The same turn is asked of the hand here as was shown: about the vertical, because it takes from above.
    const Rotation<double> turned = place.X_MH.axes() * taken().transpose();
    if (turned.z.z < 0.97) refuse(k, "the hand is tilted from how it took, and here it points down");
  }
  /// Where a tool is used: it is taken, used over the bread and put back; the bread is put on the plate.
  void understand_with_tool(std::uint8_t k, ObjectClass role) {
    using namespace activity;
    Step& s = plan_.steps[k];
    if (!is_taken(role)) refuse(k, "here are a knife, bread and plates, no " + classes_.name(s.role));
    s.role = role;
    if (s.does == &Look::rule) return;
    if (s.place == no_place) refuse(k, "it has no place");
    const auto is = [&](const auto&... rule) { return ((s.does == &rule) || ...); };
    const TaughtPlace& place = plan_.places[s.place];
    const ObjectClass mark = class_here(place.mark);
    const bool tool = role == tool_class;
    const auto& p = place.X_MH.origin();
    if (mark == 0 && place.mark != 0)
      refuse(k, "its place is beside a " + classes_.name(place.mark) + ", and there is none here");
    if (is(ReachAbove::rule, Reach::rule, Take::rule)) {
      around_orange(k, mark == role ? orange_class : ObjectClass(0), p);
    } else if (is(Find::rule, Carry::rule, Use::rule) && tool) {
      if (mark != orange_class) refuse(k, "a tool is used over the bread here");
      over_bread(k, place);
    } else if (is(Find::rule, Put::rule, Release::rule)) {
      if (tool ? mark != 0 : mark != bin_class)
        refuse(k, "here tools are put back to a place in the world, and bread is put on the plate");
      tool ? tool_put_back(k, p) : on_plate(k, p);
    } else {
      refuse(k, "these arms have no skill for it, where a tool is used");
    }
    if ((place.X_MH.axes() * taken().transpose()).z.z < 0.97)
      refuse(k, "the hand is tilted from how it took, and here it points down");
  }
  /// Nothing is cut here: the tool passes over the bread, wherever in the feed that lies.
  void over_bread(std::uint8_t k, const TaughtPlace& place) const {
    constexpr double clear = 0.01,
                     hangs = 0.034;  // of the bread; from between the fingers down to the tool's edge
    const TaughtWay& way = ways_[plan_.steps[k].place];
    if (way.size < 2) refuse(k, "the way of its use is not in the file: learn it anew");
    const Tray feed = feed_tray(0);
    for (std::size_t i = 0; i < way.size; ++i) {
      const Xyz<double> p = place.X_MH.origin() + place.X_MH.axes() * way.corners[i];
      if (p.z < bread_half + hangs + clear)
        refuse(k, text("the hand comes down to %.0f mm over the bread's middle, where the tool touches it: "
                       "nothing is "
                       "cut here",
                       1e3 * p.z));
      reached(k, {feed.x + p.x + (p.x > 0 ? 0.1 : -0.1), feed.y + p.y, p.z + bread_half});
    }
  }
  void tool_put_back(std::uint8_t k, const Xyz<double>& p) const {
    const Xyz<double> here{p.x - room_.stands, p.y, 0.2};
    reached(k, here);
    constexpr double own_half = -0.1;  // of the table, with room for a hand [m]
    if (here.y > own_half) refuse(k, "it is put back in the half of the table that is the other arm's here");
  }
  void on_plate(std::uint8_t k, const Xyz<double>& p) const {
    const Tray plate = bin_tray(0);
    const double room = plate.half_x - bread_radius;
    if (std::abs(p.x) > room || std::abs(p.y) > room || p.z < 0 || p.z > 0.1)
      refuse(k, text("the hand opens at %+.2f %+.2f %+.2f m from the plate: beside it, or too high", p.x, p.y,
                     p.z));
    reached(k, {p.x + plate.x, p.y + plate.y, 0.2});
  }
  /// A full box is taken by the wall on the arm's side, and put where a person fetches it.
  void understand_box(std::uint8_t k) {
    using namespace activity;
    const Step& s = plan_.steps[k];
    const auto is = [&](const auto&... rule) { return ((s.does == &rule) || ...); };
    if (is(Look::rule, GoBack::rule)) return;
    const bool at_wall = is(ReachAbove::rule, Reach::rule, Take::rule);
    if (!at_wall && !is(Put::rule, Release::rule))
      refuse(k, "a full box is looked for, taken by its wall, put on the shelf and let go");
    if (s.place == no_place) refuse(k, "it has no place");
    const TaughtPlace& place = plan_.places[s.place];
    const Xyz<double> off = place.X_MH.origin() - (at_wall ? wall_place : Xyz<double>{0, 0, 0});
    constexpr double beside = 0.01;
    if (class_here(place.mark) != (at_wall ? box_class : shelf_class) || !(norm(off) <= beside))
      refuse(k, at_wall
                    ? text("a full box is taken at the middle of its wall, %.3f m from its own: 10 mm beside "
                           "at most",
                           wall_place.x)
                    : std::string(
                          "a full box is put on the shelf, where a person fetches it: 10 mm beside at most"));
  }
  /// How the hand stood when it took an orange.
  [[nodiscard]] Rotation<double> taken() const {
    for (std::size_t i = 0; i < plan_.place_count; ++i)
      if (class_here(plan_.places[i].mark) == (uses_tool_ ? tool_class : orange_class))
        return plan_.places[i].X_MH.axes();
    return {};
  }
  void around_orange(std::uint8_t k, ObjectClass mark, const Xyz<double>& p) const {
    constexpr double most =
        0.012;  // that open fingers have beside the largest orange, less what a detector is off
    if (mark != orange_class) refuse(k, "a thing is taken where it is seen");
    if (norm(p) > most)
      refuse(
          k,
          text("the hand closes %.0f mm from the middle of what it takes, where its fingers come down on it: "
               "%.0f mm at most",
               1e3 * norm(p), 1e3 * most));
  }
  /// A hand that is pushed between walls needs room beside it: what is nearer to a wall than that comes nearer
  /// to the middle.
  void in_tray(std::uint8_t k, ObjectClass mark, TaughtPlace& place) const {
    if (mark != box_class && mark != bin_class) refuse(k, "oranges are put into the box or a bin here");
    const Tray tray = mark == box_class ? box_tray : bin_tray(0);
    constexpr double finger = 0.06, room = 0.09, high = 0.1;  // high: from where an orange may fall
    Xyz<double> p = place.X_MH.origin();
    if (std::abs(p.x) > tray.half_x - finger || std::abs(p.y) > tray.half_y - finger || p.z < 0 || p.z > high)
      refuse(k, text("the hand opens at %+.2f %+.2f %+.2f m from the %s: not between its walls, or too high",
                     p.x, p.y, p.z, mark == box_class ? "box" : "bin"));
    p.x = std::clamp(p.x, room - tray.half_x, tray.half_x - room);
    p.y = std::clamp(p.y, room - tray.half_y, tray.half_y - room);
    place.X_MH = {place.X_MH.axes(), p};
    reached(k, {p.x + tray.x, p.y + tray.y, 0.2});
  }
  void in_room(std::uint8_t k, ObjectClass mark, const Xyz<double>& p) const {
    if (mark != 0) refuse(k, "an orange is squeezed where it is taken, or at a place in the world");
    reached(k, {p.x - room_.stands, p.y, std::max(p.z, 0.2)});
  }
  void reached(std::uint8_t k, const Xyz<double>& p) const {
    if (!room_.reaches(p))
      refuse(k, text("its place, %.2f m from the arm and %.2f m high, is out of reach",
                     std::hypot(p.x + room_.stands, p.y), p.z));
  }
  void go_back_after_releases() {
    for (std::uint8_t k = 0; k < plan_.size; ++k) {
      if (plan_.steps[k].does != &activity::Release::rule) continue;
      const std::uint8_t next = plan_.steps[k].done;
      if (next < plan_.size && plan_.steps[next].does == &GoBack::rule) continue;
      std::uint8_t back = 0;
      while (back < plan_.size && (plan_.steps[back].does != &GoBack::rule || plan_.steps[back].done != next))
        ++back;
      if (back == Plan::capacity) refuse(k, "the task has too many steps for the way back after it");
      if (back == plan_.size) {
        const Step& release = plan_.steps[k];
        plan_.steps[plan_.size++] =
            step_of<GoBack>({.role = release.role, .done = next, .failed = release.failed});
      }
      plan_.steps[k].done = back;
    }
  }

  const teach::Classes& classes_;
  const skinctl::TaughtWays& ways_;
  HandRoom room_;
  Plan plan_;
  bool uses_tool_;
};
}  // namespace

Plan plan_of(const teach::NamedTask& task, const HandRoom& room) {
  Plan plan = Reader(task, room).plan();
  if (plan.begins.any())
    throw std::runtime_error("the task begins with " + teach::to_text(plan.begins) +
                             ": it is a part of a process");
  return plan;
}

teach::Activities activities_here() {
  static constexpr const ActivityRule* own[] = {&Lift::rule, &GoBack::rule, &FindRoom::rule};
  return own;
}

Plan plan_of_process(std::span<const std::string> files, const HandRoom& room) {
  Process process;
  process.repeats = true;
  if (files.size() > Process::max_tasks)
    throw std::runtime_error(text("a process has %zu tasks at most", Process::max_tasks));
  const auto of_task = [&](std::size_t k) {
    return text("task %zu of the process (%s), ", k + 1, files[k].c_str());
  };
  for (std::size_t k = 0; k < files.size(); ++k) try {
      process.tasks[process.size++] = Reader(teach::load(files[k], activities_here()), room).plan();
    } catch (const std::runtime_error& error) {
      throw std::runtime_error(of_task(k) + error.what());
    }
  bool boxes_go = false;
  for (const Plan& task : process.tasks) boxes_go = boxes_go || puts_boxes_away(task);
  for (Plan& task : process.tasks)
    for (std::size_t i = 0; boxes_go && i < task.size; ++i)
      if (Step& s = task.steps[i];
          s.does == &activity::Find::rule && s.place != no_place && task.places[s.place].mark == box_class)
        s.does = &FindRoom::rule;
  Plan whole;
  if (const ProcessFault f = join(process, whole); f.any()) {
    const Plan& task = process.tasks[f.task];
    const ActivityRule* does = f.fault.step < task.size ? task.steps[f.fault.step].does : nullptr;
    throw std::runtime_error(
        of_task(f.task) + text("step %d (%s): ", int(f.fault.step), does ? does->name : "?") +
        describe(f.fault.error) + (f.fault.facts.any() ? " (" + teach::to_text(f.fault.facts) + ")" : ""));
  }
  return whole;
}

}  // namespace packing

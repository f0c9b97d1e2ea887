// Two simulated arms with grippers and skin pack oranges: the good into the box, the bad into a bin.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "examples/packing_oranges/grasps.hpp"
#include "examples/packing_oranges/live.hpp"
#include "examples/packing_oranges/report.hpp"
#include "examples/packing_oranges/taught_plan.hpp"
#include "examples/packing_oranges/teach.hpp"
#include "examples/packing_oranges/ur10e.hpp"
#include "examples/support/job.hpp"
#include "examples/support/program.hpp"
#include "examples/support/svg_plot.hpp"

namespace {
using namespace packing;
using examples::job::Exit;

/// Who looks: nobody, or whoever opens the page; at the pace of the world then.
struct Live {
  bool on = false, control = false;
  std::uint16_t port = 0;
};

int run(const RunSettings& settings, const std::string& robot, const std::string& page, const Live& live,
        bool quiet) {
  std::unique_ptr<LivePage> shown;
  Show show;
  if (live.on) {
    shown = std::make_unique<LivePage>(live.port, live.control);
    std::printf("live: %s%s\n", shown->url().c_str(), live.control ? ", control allowed" : "");
    std::fflush(stdout);
    show = [&shown, begun = std::chrono::steady_clock::now()](const Scenery& s) {
      std::this_thread::sleep_until(begun + std::chrono::duration_cast<std::chrono::nanoseconds>(
                                                std::chrono::duration<double>(s.time)));
      shown->show(s);
      return shown->take();
    };
  }
  examples::job::Progress progress(quiet);
  const examples::job::StopSignals signals;
  const Watch watch = [&](double t, const Supply& supply) {
    if (progress.due(t))
      progress.show("%6.0f s: %zu of %d oranges", t, supply.ended().size(), settings.supply.oranges);
    return !signals.asked();
  };
  const Outcome out = (robot == "ur10e" ? run_ur10e : run_ur5)(settings, watch, show);
  progress.clear();
  std::fputs(summary(out, settings).c_str(), stdout);
  if (!page.empty() && !plotting::write_svg(page, report(out, settings))) return code(Exit::refused);
  if (out.stopped) return code(Exit::interrupted);
  if (!out.over) return code(Exit::not_following);
  const bool lost = settings.fault == Fault::none && out.lost() > 0;
  return code(lost || out.worst_grip() > 10 || out.shake() > 3 ? Exit::broken : Exit::fine);
}
int show_grasps(std::uint64_t seed, const std::string& page) {
  const auto trials = three_grasps();
  std::vector<GraspFigures> figures;
  for (const auto& t : trials) figures.push_back(try_grasp(t, {.seed = seed}));
  std::fputs(summary(figures).c_str(), stdout);
  std::fputs(compare_wrapped(seed).c_str(), stdout);
  if (!page.empty() && !plotting::write_svg(page, picture(trials, figures))) return code(Exit::refused);
  const bool held = std::all_of(figures.begin(), figures.end(), [](const auto& f) { return f.held; });
  return code(held ? Exit::fine : Exit::broken);
}
/// So many people teach the place in the box, each one lesson: how many are understood, and how exactly.
int lessons(int count, std::uint64_t first) {
  int understood = 0, released = 0;
  double square = 0, worst = 0, meant = 0;
  for (int i = 0; i < count; ++i) {
    const auto lesson = teach_place(first + static_cast<std::uint64_t>(i));
    if (!lesson) continue;
    const auto far = [](const auto& a, const auto& b) { return norm(skinctl::Xyz<double>(a - b)); };
    const double off = far(lesson->taught, lesson->rested), aside = far(lesson->taught, lesson->meant);
    // The place that the person went for, by their own patience of 4 mm and what the hand gives when it lets go.
    if (aside > 0.006) continue;
    ++understood, released += lesson->released ? 1 : 0;
    square += off * off, meant += aside * aside, worst = std::max(worst, off);
  }
  const double n = std::max(1, understood);
  std::printf(
      "%d lessons: the place that was meant %d times, with the opening of the hand %d times; %.3f mm rms "
      "from where "
      "the hand rested, %.3f at worst; %.1f mm rms from what was meant\n",
      count, understood, released, 1e3 * std::sqrt(square / n), 1e3 * worst, 1e3 * std::sqrt(meant / n));
  return code(understood >= 0.95 * count && released >= 0.95 * count ? Exit::fine : Exit::broken);
}
/// So many people teach arm and hand; what each one showed packs `settings.supply.oranges` others, lying elsewhere.
int lessons_by_hand(int count, const RunSettings& settings, bool onto, bool quiet) {
  int understood = 0, used = 0, right = 0, of = 0;
  int by_touch = 0, ends_at_touch = 0;
  double largest = 0, set_down = 0, fell = 0;
  struct Figure {
    const char* what;
    const char* unit;
    double HandLesson::* value;
    double scale, square = 0, worst = 0;
  } figures[] = {
      {"hand around the orange, from where it rested", "mm", &HandLesson::take, 1e3},
      {"... turned", "degrees", &HandLesson::take_turned, 180 / M_PI},
      {"... from what was meant", "mm", &HandLesson::take_meant, 1e3},
      {"hand in the box, from where it rested", "mm", &HandLesson::put, 1e3},
      {"... turned", "degrees", &HandLesson::put_turned, 180 / M_PI},
      {"... from what was meant", "mm", &HandLesson::put_meant, 1e3},
      {"fingertips around the orange, from what was meant", "mm", &HandLesson::fingers, 1e3},
  };
  std::map<std::string, std::vector<std::uint64_t>> refused;
  examples::job::Progress progress(quiet);
  for (int i = 0; i < count; ++i) {
    progress.show("%d of %d lessons", i, count);
    const std::uint64_t seed = settings.seed + static_cast<std::uint64_t>(i);
    std::string why;
    const auto lesson = teach_with_hand(seed, onto, 0, &why);
    if (!lesson) {
      refused[why.substr(0, why.find(" = "))].push_back(seed);
      continue;
    }
    ++understood;
    for (Figure& f : figures) {
      const double x = f.scale * (*lesson).*f.value;
      f.square += x * x, f.worst = std::max(f.worst, x);
    }
    if (settings.supply.oranges == 0) continue;
    RunSettings s = settings;
    s.seed = seed;
    s.hand = {true, true};
    s.work.shown = lesson->shown;
    const Outcome out = run_ur5(s, {}, {});
    used += out.over && out.right() == s.supply.oranges;
    right += out.right(), of += s.supply.oranges;
    largest = std::max(largest, out.worst_grip());
    ends_at_touch += lesson->shown.until_touched;
    for (const auto& a : out.arm) {
      by_touch += a.set_down_by_touch;
      set_down = std::max(set_down, a.set_down), fell = std::max(fell, a.fell);
    }
  }
  progress.clear();
  std::printf(
      "%d lessons: %d understood; %d used for %d oranges each without a fault, %d of %d oranges right, at "
      "most %.2f N\n",
      count, understood, used, settings.supply.oranges, right, of, largest);
  std::printf(
      "  %d end at a touch; %d oranges set down by it; at most %.1f N between an orange in the hand and what "
      "lies there; fell "
      "%.0f mm at most\n",
      ends_at_touch, by_touch, set_down, 1e3 * fell);
  for (const auto& [why, seeds] : refused) {
    std::printf("  %zu refused, %s: seeds", seeds.size(), why.c_str());
    for (const std::uint64_t seed : seeds) std::printf(" %llu", static_cast<unsigned long long>(seed));
    std::printf("\n");
  }
  for (const Figure& f : figures)
    std::printf("  %-50s %6.2f %s rms, %.2f at worst\n", f.what,
                std::sqrt(f.square / std::max(1, understood)), f.unit, f.worst);
  return code((settings.supply.oranges == 0 ? understood : used) >= 0.9 * count ? Exit::fine : Exit::broken);
}
}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Two simulated arms pack oranges.");
  app.footer(examples::job::exit_help());
  RunSettings s;
  std::string robot = "ur5", fault = "none", page, gripper = "measures";
  bool quiet = false, taught = false, grasps = false, faults = false, onto = false;
  Live live;
  app.add_option("--oranges", s.supply.oranges, "how many; 0, with --lessons and hands: nothing is packed")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  app.add_option("--robot", robot, "what the arms are: ur5 or ur10e")
      ->check(CLI::IsMember({"ur5", "ur10e"}))
      ->capture_default_str();
  app.add_option("--seed", s.seed, "other oranges, other noise")->capture_default_str();
  app.add_option("--touch-every", s.touch_every, "a person pushes each forearm so often [s]; 0: never")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  std::string world = "honest";
  app.add_option("--world", world,
                 "ideal: the detector tells which orange it sees, box and bins stand where they are known; "
                 "honest: class and place only, of box and bins that slide, too, 2 % flashes, "
                 "1 % of wrong "
                 "classes, what hands hide, and --ghosts")
      ->check(CLI::IsMember({"ideal", "honest"}))
      ->capture_default_str();
  app.add_option("--ghosts", s.detector.ghosts,
                 "oranges that the detector sees in the feeds, and that do not exist")
      ->check(CLI::Range(0, 6))
      ->capture_default_str();
  app.add_option("--friction", s.world.friction, "of the oranges")
      ->check(CLI::Range(0.02, 2.0))
      ->capture_default_str();
  double bias = 0;
  app.add_option("--bias", bias, "the detector is off by this, in some direction [mm]")
      ->check(CLI::Range(0.0, 50.0))
      ->capture_default_str();
  app.add_option("--move-box", s.move_box,
                 "a person moves the box by this, up to three times [m]; an arm finds it again")
      ->check(CLI::Range(0.0, 0.12))
      ->capture_default_str();
  app.add_option("--obstacle", s.obstacle,
                 "something moves through the room at this speed [m/s]: the arms' skin sees it and they give "
                 "way; 0: nothing does")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--fault", fault, "none, slip, no_detector, box_blocked or touch_held")
      ->check(CLI::IsMember({"none", "slip", "no_detector", "box_blocked", "touch_held"}))
      ->capture_default_str();
  app.add_option("--fault-at", s.fault_at, "when [s]")->check(CLI::Range(0.0, 1e6))->capture_default_str();
  app.add_option("--fault-lasts", s.fault_lasts, "how long [s]; 0: as is usual for it, as the report says")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  int worlds = 0;
  app.add_option("--worlds", worlds, "instead: so many runs in each of several worlds, as a table")
      ->check(CLI::Range(1, 1000));
  app.add_flag("--faults", faults, "instead: each fault at each step of the plan, as a table");
  app.add_flag("--teach", taught,
               "first a person leads an arm to the place in the box where oranges are let go");
  std::string task;
  app.add_option("--task", task,
                 "a task that was taught, as `teach learn` writes it: instead of the plan by hand");
  int taught_lessons = 0;
  app.add_option("--lessons", taught_lessons, "instead: so many people teach that place, one lesson each")
      ->check(CLI::Range(1, 100000));
  app.add_option(
         "--gripper", gripper,
         "measures: the opening as well as the force; open_or_closed: the force over time; hand: "
         "Allegro hands; hand_and_gripper: the first arm has a hand, the second one a gripper, as TOMM")
      ->check(CLI::IsMember({"measures", "open_or_closed", "hand", "hand_and_gripper"}))
      ->capture_default_str();
  app.add_flag("--onto", onto,
               "with --teach or --lessons, and hands: the person presses the orange on what lies in the box; "
               "used where that is "
               "as high as --floor says");
  app.add_option("--floor", s.world.floor, "height of what lies in the box [m]")
      ->check(CLI::Range(0.0, 0.05))
      ->capture_default_str();
  app.add_flag("--grasps", grasps,
               "instead: three grasps of a hand on three objects, shaken and turned over; --report: their "
               "picture (SVG)");
  app.add_flag("!--unseen", s.see_each_other,
               "the arms do not keep clear of each other: only the order at the box keeps them apart");
  app.add_flag("--live", live.on, "at the world's pace, seen in a browser: prints the page's address");
  app.add_option("--live-port", live.port, "port of the page; 0: any")->capture_default_str();
  app.add_flag("--allow-control", live.control, "whoever sees the page may let the arms go on after a stop");
  app.add_option("--report", page, "writes a page with pictures to this file");
  app.add_flag("--quiet", quiet, "no progress");
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  try {
    if (grasps) return show_grasps(s.seed, page);
    if (!task.empty() && (taught || taught_lessons > 0 || faults))
      throw std::runtime_error("--task: a plan of its own; not with --teach, --lessons or --faults");
    s.fault = fault_named(fault);
    s.honest = world == "honest";
    s.detector.bias = 1e-3 * bias;
    if (!s.honest && s.move_box > 0) throw std::runtime_error("--move-box: not with --world ideal");
    if (!s.honest && s.detector.ghosts > 0) throw std::runtime_error("--ghosts: not with --world ideal");
    if (onto && (gripper.rfind("hand", 0) != 0 || (!taught && taught_lessons == 0)))
      throw std::runtime_error("--onto: a lesson with hands: --teach or --lessons, and --gripper hand");
    if (s.supply.oranges == 0 && (taught_lessons == 0 || gripper != "hand"))
      throw std::runtime_error("--oranges 0: only with --lessons and --gripper hand");
    if (taught_lessons > 0 && gripper == "hand") return lessons_by_hand(taught_lessons, s, onto, quiet);
    if (taught_lessons > 0) return lessons(taught_lessons, s.seed);
    const auto one = [&](const RunSettings& given) {
      return (robot == "ur10e" ? run_ur10e : run_ur5)(given, {}, {});
    };
    if (worlds > 0) {
      bool well = true;
      std::fputs(table_of_worlds(s, worlds, one, well).c_str(), stdout);
      return code(well ? Exit::fine : Exit::not_following);
    }
    if (faults) {
      bool over = true;
      std::fputs(table_of_faults(s, one, over).c_str(), stdout);
      return code(over ? Exit::fine : Exit::not_following);
    }
    if (!task.empty()) s.work.plan = plan_of(teach::load(task), robot == "ur10e" ? Ur10e::room : Ur5::room);
    s.keep_path = !page.empty();
    if (gripper == "hand" || gripper == "hand_and_gripper") s.hand = {true, gripper == "hand"};
    s.work.by_time = gripper == "open_or_closed";
    if (taught && s.hand[0]) {
      const auto lesson = teach_with_hand(s.seed, onto);
      if (!lesson) {
        std::fprintf(stderr, "packing_oranges: nothing was taught\n");
        return code(Exit::not_following);
      }
      s.work.shown = lesson->shown;
      const auto& p = lesson->shown.X_OH.origin();
      std::printf(
          "taught in %.1f s: the hand closes at %.1f %.1f %.1f mm from an orange's middle, %.2f mm from "
          "where it rested; carries "
          "with %.1f N; opens to %.0f mm in the box, %.2f mm from where it rested\n",
          lesson->lasted, 1e3 * p.x, 1e3 * p.y, 1e3 * p.z, 1e3 * lesson->take, lesson->shown.hold,
          1e3 * lesson->shown.opening, 1e3 * lesson->put);
    } else if (taught) {
      const auto lesson = teach_place(s.seed);
      if (!lesson) {
        std::fprintf(stderr, "packing_oranges: nothing was taught\n");
        return code(Exit::not_following);
      }
      const auto mm = [](const auto& a, const auto& b) { return 1e3 * norm(skinctl::Xyz<double>(a - b)); };
      std::printf(
          "taught in %.1f s: put at %.3f %.3f %.3f m in the box, %.2f mm from where the hand rested, %.1f mm "
          "from "
          "what was meant\n",
          lesson->lasted, lesson->taught.x, lesson->taught.y, lesson->taught.z,
          mm(lesson->taught, lesson->rested), mm(lesson->taught, lesson->meant));
      s.work.plan.places[place::box].X_MH =
          skinctl::Transform<skinctl::ObjectFrame, skinctl::Tool>({}, lesson->taught);
    }
    return run(s, robot, page, live, quiet);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "packing_oranges: %s\n", error.what());
    return code(Exit::refused);
  }
}

// Two simulated arms with grippers and skin pack oranges: the good into the box, the bad into a bin.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "examples/packing_oranges/grasps.hpp"
#include "examples/packing_oranges/live.hpp"
#include "examples/packing_oranges/report.hpp"
#include "examples/packing_oranges/taught_plan.hpp"
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
  const bool lost = settings.fault == Fault::none && out.lost() + out.tool[0].lost() + out.tool[1].lost() > 0;
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
}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Two simulated arms pack oranges.");
  app.footer(examples::job::exit_help());
  RunSettings s;
  std::string robot = "ur5", fault = "none", page, gripper = "measures";
  bool quiet = false, grasps = false, faults = false;
  Live live;
  app.add_option("--oranges", s.supply.oranges, "how many")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--robot", robot, "what the arms are: ur5 or ur10e")
      ->check(CLI::IsMember({"ur5", "ur10e"}))
      ->capture_default_str();
  app.add_option("--seed", s.seed, "other oranges, other noise")->capture_default_str();
  app.add_option("--touch-every", s.touch_every, "a person pushes each forearm so often [s]; 0: never")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  app.add_option("--touch-force", s.touch_force, "with so much [N]")
      ->check(CLI::Range(0.0, 300.0))
      ->capture_default_str();
  app.add_flag("!--nobody-answers", s.answers,
               "no person comes when an arm asks, and it goes on after 20 s; else one does after 5 to 60 s "
               "(--world ideal: after a second)");
  app.add_option("--dead-cells", s.dead_cells,
                 "of the 40 cells that feel on each forearm, so many say nothing")
      ->check(CLI::Range(0, 40))
      ->capture_default_str();
  std::string world = "honest";
  app.add_option("--world", world,
                 "ideal: the detector tells which orange it sees, box and bins stand where they are known; "
                 "honest: class and place only, of box and bins that slide, too, 2 % flashes, "
                 "1 % of wrong "
                 "classes, what hands hide, and --ghosts")
      ->check(CLI::IsMember({"ideal", "honest"}))
      ->capture_default_str();
  app.add_flag(
      "--stay", s.stay,
      "oranges stay in box and bins until a person puts full ones away; else each leaves after 0.5 s");
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
  app.add_option(
         "--move-box", s.move_box,
         "a person moves the box by this, up to three times [m], or the bread once while an arm has its "
         "tool in the hand; the arm finds it again")
      ->check(CLI::Range(0.0, 0.12))
      ->capture_default_str();
  app.add_option("--obstacle", s.obstacle,
                 "something moves through the room at this speed [m/s]: the arms' skin sees it and they give "
                 "way; 0: nothing does")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--fault", fault,
                 "none, slip, no_detector, box_blocked, touch_held, arm_stopped or (--process) box_held")
      ->check(CLI::IsMember(
          {"none", "slip", "no_detector", "box_blocked", "touch_held", "arm_stopped", "box_held"}))
      ->capture_default_str();
  app.add_option("--fault-at", s.fault_at, "when [s]")->check(CLI::Range(0.0, 1e6))->capture_default_str();
  app.add_option("--fault-lasts", s.fault_lasts, "how long [s]; 0: as is usual for it, as the report says")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  int worlds = 0;
  app.add_option("--worlds", worlds, "instead: so many runs in each of several worlds, as a table")
      ->check(CLI::Range(1, 1000));
  app.add_flag("--faults", faults, "instead: each fault at each step of the plan, as a table");
  std::string task;
  app.add_option(
      "--task", task,
      "a task that was taught, as `teach learn` writes it: instead of the plan by hand; with oranges, or "
      "with a knife that is used over bread");
  std::vector<std::string> process;
  const auto* by_process = app.add_option("--process", process,
                                          "oranges stay, and an arm puts the full box away: sort, pack, put "
                                          "away as a process. FILES: another "
                                          "one, of the tasks in these files, in their order")
                               ->expected(0, int(Process::max_tasks))
                               ->type_name("[FILES]");
  bool two_tables = false;
  app.add_flag("--two-tables", two_tables,
               "the oranges lie on one table, the box stands on another one: the robot drives between them");
  app.add_option("--gripper", gripper,
                 "measures: the opening as well as the force; open_or_closed: the force over time; hand: "
                 "Allegro hands; binary: takes only open and close, the wrist presses to judge; "
                 "hand_and_gripper: the first arm has a hand, the second one a gripper, as TOMM")
      ->check(CLI::IsMember({"measures", "open_or_closed", "binary", "hand", "hand_and_gripper"}))
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
    if (!task.empty() && faults) throw std::runtime_error("--task: a plan of its own; not with --faults");
    s.fault = fault_named(fault);
    s.honest = world == "honest";
    s.detector.bias = 1e-3 * bias;
    if (!s.honest && s.move_box > 0) throw std::runtime_error("--move-box: not with --world ideal");
    if (!s.honest && s.stay) throw std::runtime_error("--stay: not with --world ideal");
    if (!s.honest && s.detector.ghosts > 0) throw std::runtime_error("--ghosts: not with --world ideal");
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
    const teach::NamedTask taught = task.empty() ? teach::NamedTask{} : teach::load(task);
    if (!task.empty()) s.work.plan = plan_of(taught, robot == "ur10e" ? Ur10e::room : Ur5::room);
    if (*by_process) {
      if (!task.empty() || faults || worlds > 0 || s.obstacle > 0)
        throw std::runtime_error("--process: not with --task, --faults, --worlds or --obstacle");
      if (!s.honest) throw std::runtime_error("--process: not with --world ideal, whose box cannot be moved");
      if (gripper.find("hand") == 0)
        throw std::runtime_error(
            "--process: an Allegro hand takes nothing as thin as the wall of a box here; a gripper does");
      if (gripper == "binary")
        throw std::runtime_error(
            "--process: a gripper that is only open or closed cannot let a box go that gets stuck: it tells "
            "no force");
      s.stay = true;
      std::erase_if(process, [](const std::string& file) { return file.empty() || file == "{}"; });
      s.work.plan = process.empty() ? process_by_hand
                                    : plan_of_process(process, robot == "ur10e" ? Ur10e::room : Ur5::room);
    }
    if (two_tables) {
      if (!task.empty() || *by_process || faults || worlds > 0 || s.obstacle > 0 || s.stay)
        throw std::runtime_error(
            "--two-tables: not with --task, --process, --faults, --worlds, --obstacle or --stay");
      if (!s.honest)
        throw std::runtime_error("--two-tables: not with --world ideal, which looks nowhere again");
      s.work.plan = process_between_tables;
    }
    s.keep_path = !page.empty();
    if (gripper == "hand" || gripper == "hand_and_gripper") s.hand = {true, gripper == "hand"};
    s.work.by_time = gripper == "open_or_closed";
    if (gripper == "binary") s = with_binary_grippers(s);
    if (uses_tool(s.work.plan)) s = with_tool(s, taught.ways);
    return run(s, robot, page, live, quiet);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "packing_oranges: %s\n", error.what());
    return code(Exit::refused);
  }
}

// A run of the whole: the world, two arms that pack, and a person who touches them.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <vector>

#include "examples/packing_oranges/detector.hpp"
#include "examples/packing_oranges/kitchen.hpp"
#include "examples/packing_oranges/scenery.hpp"
#include "examples/packing_oranges/supply.hpp"
#include "examples/packing_oranges/work.hpp"
#include "skinctl/cycle/input.hpp"

namespace packing {

/// What goes wrong in a run, once.
enum class Fault : unsigned char { none, slip, no_detector, box_blocked, touch_held, box_held, arm_stopped };

struct RunSettings {
  SupplySettings supply{};
  WorldSettings world{};
  DetectorSettings detector{};
  WorkSettings work{};
  std::uint64_t seed = 1;
  double touch_every = 20;  ///< a person pushes each forearm so often [s]; 0: never
  double touch_force = 12;  ///< [N]
  /// A person who is asked comes after so long, at least and at most [s]; a second after a fault in an ideal
  /// world.
  double answers_after = 5, answers_within = 60;
  bool answers = true;            ///< a person comes at all
  double touch_lasts = 0.6;       ///< [s]
  std::array<bool, arms> hand{};  ///< the arm has an Allegro hand instead of a gripper
  double skin_noise = 0.1;        ///< deviation of a cell's force [N]
  std::size_t dead_cells = 0;     ///< cells of each forearm, of 40, that have fallen silent
  bool honest = true;          ///< the detector tells no numbers and is wrong at times; the arms believe less
  bool stay = false;           ///< honest: oranges stay in box and bins until a person puts full ones away
  bool see_each_other = true;  ///< false: only places and their order keep the arms apart
  double obstacle = 0;         ///< something moves through the room at this speed [m/s]; 0: nothing
  double move_box = 0;         ///< honest: a person moves the box so far, see `BoxMover` [m]; 0: nobody does
  Fault fault = Fault::none;
  double fault_at = 12;    ///< [s]
  int fault_step = -1;     ///< if it is one of the plan's: when the first arm begins that step, instead
  double fault_lasts = 0;  ///< [s]; 0: as long as is usual for it
  double longest = 0;      ///< [s] of simulated time; 0: enough for the oranges
  bool keep_path = false;  ///< of the hands, for pictures
};

/// The same work by a hand: forces that it can exert, heights and places at which it has room.
[[nodiscard]] WorkSettings by_hand(WorkSettings settings);
/// The same run of a task that uses a tool, with the ways of its use. Throws std::runtime_error for what is
/// not built for tools.
[[nodiscard]] RunSettings with_tool(RunSettings settings, const skinctl::TaughtWays& ways);
/// The same run with grippers that are only open or closed. Throws std::runtime_error for a plan that squeezes what
/// does not stand.
[[nodiscard]] RunSettings with_binary_grippers(RunSettings settings);

/// Shown every 32 ms of simulated time where somebody looks; what is returned is asked of both arms.
using Show = std::function<skinctl::CycleRequest(const Scenery&)>;

/// What one arm did.
struct ArmOutcome {
  std::vector<Done> done;
  struct Judged {
    double stiffness = 0, truth = 0, time = 0;
    bool said_good = false, good = false;
  };
  std::vector<Judged> judged;
  double worst_grip = 0;                   ///< force of a finger while both hold something [N]
  double worst_press = 0;                  ///< of a held orange on the table, binary grippers [N]
  double worst_force = 0;                  ///< of a finger, bumps into what lies there included [N]
  double shake = 0;                        ///< rms acceleration of a fingertip while it carries [m/s^2]
  double waited = 0;                       ///< for the box [s]
  double busy = 0;                         ///< until its last orange was done [s]
  double worst_push = 0;                   ///< largest force on a full box that it moves [N]
  int touches = 0, asked = 0;              ///< how often it was touched, and a person was asked
  int went_aside = 0;                      ///< how often, for the other arm
  std::uint64_t other_arm = 0, walls = 0;  ///< milliseconds in contact
  std::uint64_t longest_at_wall = 0;       ///< milliseconds at a wall or the table without a break
  double wall_force = 0;                   ///< largest force between the arm and a wall or the table [N]
  std::uint64_t obstacle = 0;              ///< the same with what moves through the room
  double into_obstacle = 0;                ///< its own speed when they met [m/s]
  int gave_way = 0;                        ///< how often, to something that its skin saw
  double hold = 0;                         ///< force of carrying in the end [N]
  std::vector<skinctl::Xyz<double>>
      slipped;           ///< places of oranges that slipped out of the firmest grip, and are left
  bool gave_up = false;  ///< it ended because it went back too often in a row
  int empty_takes = 0;   ///< how often a hand found nothing where it believed an orange
  std::vector<skinctl::Xyz<double>> doubted;  ///< places at which it saw something that hands did not find
  skinctl::Xyz<double> bias{0, 0, 0};         ///< from where it sees oranges to where it found them [m]
  int set_right = 0;                          ///< by a person, after it was pushed off its place
  struct Point {
    double t = 0, x = 0, y = 0, z = 0, force = 0, opening = 0;
    bool touched = false;
  };
  std::vector<Point> path;
};
struct Outcome {
  std::array<ArmOutcome, arms> arm;
  std::vector<Packed> ended;
  int oranges = 0;
  double time = 0;          ///< simulated [s]
  double computed = 0;      ///< processor time [s]
  double cycle = 0;         ///< mean processor time of a cycle of an arm with its executor [us]
  double hand_cycle = 0;    ///< the same of a hand; 0: it has none
  int box_moved = 0;        ///< how often, by a person
  int put_away = 0;         ///< full boxes and bins, by a person
  int drives = 0;           ///< between two tables, ...
  int halts = 0;            ///< ... how often it halted because somebody touched an arm, ...
  int corrections = 0;      ///< ... and drove on because it stood too far off
  Standing wheels_off{};    ///< where it stands in the end, from what the wheels alone tell
  double stood_off = 0;     ///< where it stood while it worked, from where it took itself to stand, most [m]
  double stood_turned = 0;  ///< the same of its turn [rad]
  std::array<ToolOutcome, arms> tool{};  ///< where a tool is used
  int fetched = 0;                       ///< of these, boxes that a person fetched where an arm had put them
  int passes = 0;                        ///< of the thing that moves through the room
  double nearest = 1e9;                  ///< it came to an arm, as capsules [m]
  /// Both plans have ended; all oranges are packed, or the others are doubted (honest), or left by an arm that
  /// gave up.
  bool over = false;
  bool stopped = false;
  std::string robot;
  double fault_begins = 0, fault_ends = 0;

  [[nodiscard]] int right() const;
  [[nodiscard]] int misjudged() const;
  [[nodiscard]] int left() const { return oranges - static_cast<int>(ended.size()); }
  [[nodiscard]] int lost() const;
  [[nodiscard]] double worst_grip() const;
  [[nodiscard]] double worst_force() const;
  [[nodiscard]] double shake() const;
  [[nodiscard]] double seconds_an_orange() const;  ///< and arm
};

/// Watches a run: called every simulated tenth of a second; false ends it.
using Watch = std::function<bool(double time, const Supply&)>;

Outcome run_ur5(const RunSettings& settings, const Watch& watch = {}, const Show& show = {});
Outcome run_ur10e(const RunSettings& settings, const Watch& watch = {}, const Show& show = {});

/// How the plan of the first arm met the fault.
enum class Met : unsigned char { went_on, tried_again, went_back, asked, not_over };
Met how_met(const Outcome& outcome);
/// Each fault at each step of the plan: how it was met, and whether the oranges are where they belong; as a table of
/// text. `run` is `run_ur5` or another one; false in `all_over`: a run that did not end.
std::string table_of_faults(const RunSettings& settings,
                            const std::function<Outcome(const RunSettings&)>& run, bool& all_over);

/// So many runs in each of several worlds, from the settings' seed on, as a table of text. false in `well`: a
/// run in an honest one did not end.
std::string table_of_worlds(const RunSettings& settings, int runs,
                            const std::function<Outcome(const RunSettings&)>& run, bool& well);

/// The fault of this name. Throws std::runtime_error for another one.
Fault fault_named(const std::string& name);
/// What happens, in words.
const char* describe(Fault fault);
/// How long it lasts unless it is said otherwise [s].
double duration(Fault fault);

}  // namespace packing

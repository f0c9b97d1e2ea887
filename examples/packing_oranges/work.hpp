// The numbers of the work, and its log.
#pragma once

#include <vector>

#include "examples/packing_oranges/finger_room.hpp"
#include "examples/packing_oranges/free_spot.hpp"
#include "examples/packing_oranges/hand.hpp"
#include "examples/packing_oranges/plan.hpp"
#include "skinctl/semantics/executor.hpp"
#include "skinctl/semantics/world.hpp"

namespace packing {

/// Numbers of the motions and of the judgement.
struct WorkSettings {
  double carry = 0.20;        ///< height of the hand on its way [m]
  double above = 0.14;        ///< over an orange that it will take [m]
  double above_near = 0.02;   ///< how near the hand must be over it [m]
  double acceleration = 2.2;  ///< largest of a motion [m/s^2]
  double speed = 0.8;         ///< [m/s]
  double let_go = 0.006;      ///< it lets go so much higher than it took [m], and ...
  double aside = 0;           ///< ... beside the middle of bin or box, away from the other arm's feed [m]
  double hold = 5;            ///< force of carrying [N], ...
  double max_hold = 8.5;      ///< ... largest, where things slip; at 10 N an orange counts as bruised
  double lightly = 1.6;       ///< ... before it is squeezed where it is brought to
  double judge_from = 1.2, judge_to = 5.6;  ///< forces between which a squeeze is judged [N]
  double judge_span = 2.5;                  ///< it must have risen by so much [N]
  bool turns = true;  ///< the hand turns so that its open fingers come down beside what lies near an orange
  std::vector<skinctl::Xyz<double>> finger_ways{two_fingers.begin(),
                                                two_fingers.end()};  ///< see `finger_room`
  /// Mean force of the fingers from which one of them stands on something [N].
  double stands_on = 3;
  bool stay = false;  ///< oranges stay in box and bins: it lets go beside those that lie there, or just above
  OpenFingers fingers{};
  std::size_t full_box = 8;  ///< number of oranges of a full box
  /// Force of each finger on a wall of a box that is moved [N]. The fingers push by their shape, so it need only be
  /// felt; it is less than what bruises an orange that the inner finger may touch.
  double hold_box = 8;
  /// Mean force of both fingers from which the box is stuck, and is let go [N]: then one of them presses with twice as
  /// much, 28 N. A box of 1.5 kg with 8 oranges slides with 11.5 N; a hand that is pinched may get 65 N.
  double box_is_stuck = 14;
  double box_speed = 0.08;  ///< largest speed of a box that is moved [m/s]
  bool honest = false;      ///< the detector tells no numbers: it takes what it believes, see `Believed`
  /// Ways back in a row, with no orange put, after which a person is asked, once; after half as many more the
  /// arm gives up, and leaves what lies there.
  int in_vain = 20;
  bool by_time = false;  ///< the gripper tells no opening: it is judged by the rise of its force
  /// The gripper is only open or closed: the wrist presses what it holds, and its way over the force judges.
  bool presses = false;
  skinctl::TaughtWays ways{};  ///< of tools in use
  bool drives = false;         ///< the arms stand on a base that drives between two tables
  /// Goal of the force of a press [N]; it ends at `judge_to`, and fingers slide at the friction of both, 8 N.
  double press = 6;
  double feels = 0.8;  ///< force from which what is set down is felt to stand [N]
  Plan plan = pack_oranges;
  skinctl::ExecutorSettings executor{.max_place_wait = 12s};
};

/// Numbers of the work that no run changes.
struct WorkNumbers {
  static constexpr double walls_off = 0.005;  ///< walls are moved; the clearance's margin is 20 mm [m]
  /// Age of a place that is known, and of one between whose walls a hand may go: nine pictures.
  static constexpr skinctl::Nanoseconds marked_for = 1s, goes_down_for = 300ms;
  static constexpr double strays =
      0.012;  ///< a place that moved is gone for anew; the walls are 50 mm away [m]
  static constexpr double closing_speed = 0.015;  ///< of `Squeezing` [m/s]
  static constexpr double comes_down_on = 3;  ///< more force than of carrying: it comes down on something [N]
  static constexpr double clear_of_table =
      0.003;  ///< of what is set down: it may hang lower than it was taken [m]
  static constexpr skinctl::Nanoseconds untouched = 200ms;  ///< since a push, before a press begins
  static constexpr skinctl::Nanoseconds hesitates = 300ms;  ///< after it saw something for the last time
  static constexpr double around =
      0.05;  ///< a hand that is less above an orange's middle has it between its fingers [m]
  static constexpr double turning = 2;  ///< of the hand, at most [rad/s]
};

/// A step of the plan, as it went.
struct Done {
  std::uint8_t step = 0;
  const skinctl::ActivityRule* does = nullptr;
  bool back = false;                                      ///< the way back after a failure
  bool asks = false;                                      ///< waited for a person
  skinctl::StepFailure why = skinctl::StepFailure::none;  ///< how it ended
  double from = 0, to = 0;                                ///< [s]
};

}  // namespace packing

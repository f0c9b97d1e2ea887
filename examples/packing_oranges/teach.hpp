// Steps that are taught by leading an arm: where in the box an orange is let go; with a hand also how it is taken.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "examples/packing_oranges/work.hpp"
#include "skinctl/semantics/demonstration.hpp"

namespace packing {

struct Lesson {
  skinctl::Xyz<double> meant{0, 0, 0};   ///< where the person led the hand [m, the box's frame]
  skinctl::Xyz<double> taught{0, 0, 0};  ///< what the demonstration says
  skinctl::Xyz<double> rested{0, 0, 0};  ///< where the hand really stood when it had been left alone
  double lasted = 0;                     ///< [s]
  bool released = false;                 ///< the switch was understood as well
};

/// A simulated person leads the first arm by its hand, closed as around an orange, to a place in the box, leaves it alone
/// and presses the switch that opens it. The arm has six cells around its hand and gives way; the world is the one in
/// which it works. Nothing: the demonstration had no such goal.
[[nodiscard]] std::optional<Lesson> teach_place(std::uint64_t seed);

/// A lesson with a hand, and how far it is from the truth that only the world knows.
struct HandLesson {
  Shown shown;
  double take = 0;         ///< where the hand stands around the orange, from where it rested there [m], ...
  double take_turned = 0;  ///< ... and turned from it [rad]
  double take_meant = 0;   ///< ... from where the person meant it [m]
  double put = 0;          ///< the same where it lets go [m], ...
  double put_turned = 0;   ///< ... [rad], ...
  double put_meant = 0;    ///< ... [m]
  double fingers =
      0;  ///< fingertips that take part, from where the person meant them around the orange, rms [m]
  double lasted = 0;  ///< [s]
};

/// A simulated person takes the first arm by its skin and its Allegro hand by the fingertips, both of which give way, and packs one
/// orange with them: leads the fingers open and the arm down, leaves the arm alone, closes the fingers until they press, lets go
/// of them (the hand keeps what it holds), leads the arm with the orange into the box, leaves it alone, pulls the fingers open. No
/// button: the force between the fingers says when something was taken. The person's hand wanders by 2 mm and trembles.
/// The arm knows the orange from its detector. Nothing: the demonstration had no such steps, or fingers that could not follow.
///
/// @param onto  the person presses the orange on what lies in the box, with 5 to 9 N, before the arm is left alone: the goal ends
///              with that touch. Else it ends at its place.
/// @param floor  height of what lies in the box [m].
/// @param why  of a lesson that is refused: in words.
[[nodiscard]] std::optional<HandLesson> teach_with_hand(std::uint64_t seed, bool onto = false,
                                                        double floor = 0, std::string* why = nullptr);

}  // namespace packing

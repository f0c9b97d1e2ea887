// Three grasps of an Allegro hand on three objects: each is handed over, shaken, turned over and back. Fig. 8 e.
#pragma once

#include <string>
#include <vector>

#include "examples/packing_oranges/hand.hpp"
#include "examples/packing_oranges/world.hpp"

namespace packing {

/// A grasp, what it holds, and where that is between the fingers.
struct GraspTrial {
  Grasp grasp;
  Thing thing;
  const char* words = "";
  skinctl::Transform<skinctl::Base, skinctl::Tool> X_HT;  ///< of the thing in the hand's frame
  double force = 3;                                       ///< mean of the fingertips, or of the phalanges [N]
};
/// A ball between thumb and two fingers; a bottle in all fingers; a plate at its edge between thumb and index.
[[nodiscard]] std::vector<GraspTrial> three_grasps();

/// The bottle in a hand that wraps it: the phalanges of all fingers, and the palm.
[[nodiscard]] GraspTrial wrapped_bottle();

struct GraspSettings {
  double shake = 3;           ///< amplitude of the hand's acceleration [m/s^2]
  bool feels_gravity = true;  ///< false: the hand's cycle takes it for pointing down, however the arm stands
  double until = 18;          ///< [s]
  /// Instead of all that, a person pulls in this direction, of length 1 in the hand's frame, by 5 N more each second.
  skinctl::Xyz<double> pull{0, 0, 0};
  std::uint64_t seed = 1;
};
struct GraspFigures {
  std::string name;
  double mass = 0;    ///< [kg]
  bool held = false;  ///< two fingertips or more touched it all the time
  double least = 0, mean = 0,
         most = 0;        ///< force of a fingertip that takes part, from the handing over on [N]
  double gave_way = 0;    ///< farthest that it moved in the hand [m]
  double shaken_off = 0;  ///< the same from where it lay half a second after it was let go [m]
  double slipped = 0;     ///< ... and is away in the end, the hand as in the beginning
  double turned = 0;      ///< ... and is turned in the end [rad]
  double shaken = 0;      ///< largest acceleration of the palm while it was shaken [m/s^2]
  double bent =
      0;  ///< farthest that a finger without a part in the grasp hung off its posture [rad]; 0: there is none
  int touch = 0;           ///< phalanges that touched it when the person let go, ...
  double all = 0;          ///< ... and all their forces, and the palm's [N]
  double most_torque = 0;  ///< largest of a joint, from then on [N m]
  double pulled = 0;       ///< force that moved it by 15 mm in the hand, or 80: none did [N]
  struct Point {
    double t = 0;
    std::array<double, 4> tips{};
    double moved = 0;
  };
  std::vector<Point> path;
  std::array<std::array<skinctl::Xyz<double>, 5>, 4> fingers{};  ///< as it held [m, the hand's frame]
};
/// The person lets go when the hand says that it holds, within 3 s; shaken from 4 to 8 s, turned over from 9 to 12 s, back from 13.5 to 16.5 s; 18 s in all.
[[nodiscard]] GraspFigures try_grasp(const GraspTrial& trial, const GraspSettings& settings = {});

/// How a bottle is held by the fingertips, and wrapped: shaken and turned over; and the force that pulls it out, along
/// it, towards the fingertips and away from the palm. As a table.
[[nodiscard]] std::string compare_wrapped(std::uint64_t seed);

[[nodiscard]] std::string summary(const std::vector<GraspFigures>& figures);
/// An SVG file: each grasp from the side, its forces and how far the object moved.
[[nodiscard]] std::string picture(const std::vector<GraspTrial>& trials,
                                  const std::vector<GraspFigures>& figures);

}  // namespace packing

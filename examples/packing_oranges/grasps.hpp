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
  double force = 3;                                       ///< mean of the fingertips [N]
};
/// A ball between thumb and two fingers; a bottle in all fingers; a plate at its edge between thumb and index.
[[nodiscard]] std::vector<GraspTrial> three_grasps();

struct GraspSettings {
  double shake = 3;           ///< amplitude of the hand's acceleration [m/s^2]
  bool feels_gravity = true;  ///< false: the hand's cycle takes it for pointing down, however the arm stands
  double until = 18;          ///< [s]
  std::uint64_t seed = 1;
};
struct GraspFigures {
  std::string name;
  double mass = 0;    ///< [kg]
  bool held = false;  ///< two fingertips or more touched it all the time
  double least = 0, mean = 0,
         most = 0;      ///< force of a fingertip that takes part, from the handing over on [N]
  double gave_way = 0;  ///< farthest that it moved in the hand [m]
  double slipped = 0;   ///< ... and is away in the end, the hand as in the beginning
  double turned = 0;    ///< ... and is turned in the end [rad]
  double shaken = 0;    ///< largest acceleration of the palm while it was shaken [m/s^2]
  double bent =
      0;  ///< farthest that a finger without a part in the grasp hung off its posture [rad]; 0: there is none
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

[[nodiscard]] std::string summary(const std::vector<GraspFigures>& figures);
/// An SVG file: each grasp from the side, its forces and how far the object moved.
[[nodiscard]] std::string picture(const std::vector<GraspTrial>& trials,
                                  const std::vector<GraspFigures>& figures);

}  // namespace packing

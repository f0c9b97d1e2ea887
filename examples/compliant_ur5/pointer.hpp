// The pointer of a page as a finger on the simulated arm.
#pragma once

#include <string_view>
#include <vector>

#include "examples/adapters/live/foxglove_server.hpp"
#include "examples/simulated_ur5/simulated_ur5.hpp"
#include "skinctl/recording/run_description.hpp"

namespace compliant_ur5 {

/// The topic `/simulation/finger` of a live view: whoever sees the page presses the arm, which is no real
/// one.
///
/// A message: `{"press": 7, "link": "forearm_link", "point": [x, y, z], "normal": [x, y, z], "stiffness":
/// 3000, "travel": 0.06, "aside": [x, y, z]}`, several times a second while it presses. A new number of
/// `press` is a new press, 0 lifts the finger. After 0.5 s of silence it leaves, and comes with the next
/// message. Point and normal in the frame of the link that `/tf` calls so, aside in the base's; m, N/m.
class Pointer {
 public:
  static constexpr const char* topic = "/simulation/finger";

  Pointer(simulated_ur5::SimulatedUr5& robot, std::vector<skinctl::RunFrame> frames)
      : robot_(robot), frames_(std::move(frames)) {}

  [[nodiscard]] adapters::live::Inlet inlet();
  /// The answer is the force on the finger, which not every place of the arm feels [N]. Not done: not
  /// understood, and nothing happens.
  adapters::live::Answer take(std::string_view message);
  void lift();

 private:
  simulated_ur5::SimulatedUr5& robot_;
  std::vector<skinctl::RunFrame> frames_;
  double press_ = 0;  ///< number of the present one; 0: none
};

}  // namespace compliant_ur5

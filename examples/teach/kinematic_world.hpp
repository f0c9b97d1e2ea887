// A world without forces in which a hand does what an executor asks: other places, other things than were
// shown.
#pragma once

#include <array>
#include <atomic>

#include "examples/teach/task_file.hpp"
#include "skinctl/testing/random.hpp"

namespace teach {

/// A thing, and where it ends.
struct WorldThing {
  skinctl::ObjectClass kind = 0;
  skinctl::Xyz<double> p{0, 0, 0};   ///< in the world [m]
  double stiffness = 3000;           ///< force over the way of the fingers [N/m]
  skinctl::ObjectClass ends_at = 0;  ///< class of the landmark that it was put to; 0: the world
  bool placed = false;
};
struct RunResult {
  std::vector<WorldThing> things;
  double lasted = 0;  ///< [s]
  int requests = 0, failures = 0, questions = 0;
  bool finished = false;
};

/// Runs a task among `count` things of each class that is taken in a loop, one of each other, and one of each
/// landmark, at random places: the hand moves at 0.5 m/s, one take in ten fails. `tell` says each step that
/// begins.
[[nodiscard]] RunResult run(const NamedTask& task, int count, std::uint64_t seed, double pace, bool tell,
                            const std::atomic<bool>& stopped);

}  // namespace teach

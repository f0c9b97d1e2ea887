// What rounding makes of a closed loop in the long run: `rounding [sub-steps] [seconds of float]`.
//
// A UR5 with 260 cells goes to goals, is touched, and follows its commands at once; a goal every four
// seconds, a touch every second. First three runs whose every result is rounded up or down by lot
// (`Stochastic`), in double and in float: how far apart they are after so many sub-steps. Then the same loop
// in float and in double side by side, for so many seconds of the robot's time: the largest difference of a
// command, against the resolution of an encoder of 17 bits (4.8e-5 rad). Where a comparison (does the skin
// push against the plan?) falls the other way in float, the plan waits a sub-step more or less, until the
// next goal. A day is `rounding 43200000 86400` (sub-steps of 2 ms).
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>

#include "bench/studies/worlds/stochastic.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// The loop in scalar T.
template <class T>
class Loop {
 public:
  Loop() : scene_(reaching_scene<Interface::position, 260, T>()) {
    state_.q = home_position<T>();
    memory_ = std::make_unique<Memory>(scene_.start(state_));
    input_ = std::make_unique<Input>();
  }
  void step() {
    ++cycle_;
    const Nanoseconds now = cycle_ * 8ms;
    input_->now = state_.time = now;
    input_->measured = state_;
    const auto second = static_cast<std::uint32_t>(cycle_ / 125);
    input_->goal.reset();
    if (cycle_ % 500 == 1) {
      JointPosition<6, T> goal = home_position<T>();
      for (std::size_t i = 0; i < 6; ++i)
        goal[i] += T(0.25 * std::sin(double(cycle_ / 500) * 2.0 + double(i)));
      input_->goal = JointGoal<6, T>{goal, 3s};
    }
    const float reading = cycle_ % 125 < 40 ? 0.25f : 0.0f;
    sample_ = {.time = now - 1ms, .cell = 20 + 17 * (second % 14), .force = {reading, 0, 0}};
    input_->samples = {&sample_, 1};
    const auto out = scene_.step(*memory_, *input_);
    valid_ = valid_ && out.command.valid;
    status_ = out.status;
    state_.q = out.command.position;
    state_.dq = out.planned.velocity;
  }
  const State<6, T>& state() const { return state_; }
  bool valid() const { return valid_; }
  Status status() const { return status_; }

 private:
  using Scene = decltype(reaching_scene<Interface::position, 260, T>());
  using Memory = typename Scene::Memory;
  using Input = typename Scene::Input;
  Scene scene_;
  std::unique_ptr<Memory> memory_;
  std::unique_ptr<Input> input_;
  State<6, T> state_;
  CellSample sample_;
  std::int64_t cycle_ = 0;
  bool valid_ = true;
  Status status_;
};

template <class A, class B>
double apart(const Loop<A>& a, const Loop<B>& b) {
  double most = 0;
  for (std::size_t i = 0; i < 6; ++i)
    most =
        std::max(most, std::abs(static_cast<double>(a.state().q[i]) - static_cast<double>(b.state().q[i])));
  return most;
}
double processor_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

template <class R>
void by_lot(const char* name, long substeps) {
  const double begin = processor_seconds();
  std::array<std::unique_ptr<Loop<Stochastic<R>>>, 3> runs;
  std::array<std::uint64_t, 3> seeds = {1234567, 7654321, 31415926};
  for (std::size_t k = 0; k < 3; ++k) runs[k] = std::make_unique<Loop<Stochastic<R>>>();
  double most = 0;
  for (long cycle = 1; 4 * cycle <= substeps; ++cycle) {
    for (std::size_t k = 0; k < 3; ++k) {
      Stochastic<R>::seed() = seeds[k];
      runs[k]->step();
      seeds[k] = Stochastic<R>::seed();
    }
    for (std::size_t k = 0; k < 3; ++k) most = std::max(most, apart(*runs[k], *runs[(k + 1) % 3]));
  }
  std::printf("%-6s %ld sub-steps: three runs at most %.2e rad apart, %.2e at the end; %s; %.0f s\n", name,
              substeps, most, std::max(apart(*runs[0], *runs[1]), apart(*runs[1], *runs[2])),
              runs[0]->valid() ? "valid" : "INVALID", processor_seconds() - begin);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const long substeps = argc > 1 ? std::atol(argv[1]) : 100000;
  const long seconds = argc > 2 ? std::atol(argv[2]) : 3600;
  by_lot<double>("double", substeps);
  by_lot<float>("float", substeps);
  const double begin = processor_seconds();
  Loop<float> in_float;
  Loop<double> in_double;
  constexpr double apart_much = 1e-5;
  double most = 0, most_else = 0, of_goal = 0, moved = 0;
  long otherwise = 0, far = 0, goals_far = 0;
  const auto home = home_position<double>();
  for (long cycle = 0; cycle < seconds * 125; ++cycle) {
    in_float.step(), in_double.step();
    const double d = apart(in_float, in_double);
    most = std::max(most, d);
    if (d > apart_much) ++far;
    if (!(in_float.status() == in_double.status())) ++otherwise;
    if (cycle % 500 == 0) {  // the next goal: a plan that waited a sub-step more or less is gone
      if (of_goal > apart_much) {
        ++goals_far;
      } else {
        most_else = std::max(most_else, of_goal);
      }
      of_goal = 0;
    }
    of_goal = std::max(of_goal, d);
    for (std::size_t i = 0; i < 6; ++i) moved = std::max(moved, std::abs(in_double.state().q[i] - home[i]));
  }
  std::printf(
      "float against double, %ld s of the loop: at most %.2e rad apart (an encoder of 17 bits: 4.8e-05), "
      "moved %.2f rad; %s; %.0f s\n",
      seconds, most, moved, in_float.valid() && in_double.valid() ? "valid" : "INVALID",
      processor_seconds() - begin);
  std::printf(
      "reasons differ in %ld cycles of %ld; above %.0e rad in %ld, of %ld goals; at most %.2e rad during the "
      "others\n",
      otherwise, seconds * 125, apart_much, far, goals_far, most_else);
}

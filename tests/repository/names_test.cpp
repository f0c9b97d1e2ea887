// compiled alone: its names must be global
// not sanitized: it is about compiling
// A user's file with names of its own for common things, after `using namespace skinctl`: none is taken.
#include <doctest/doctest.h>

#include "skinctl/skinctl.hpp"

using namespace skinctl;

// Types, in a scope in which a name of skinctl's would be just as near.
struct Task {};
struct Text {};
struct Model {};
struct Goal {};
struct Share {};
struct Role {};
struct Mode {};
struct Reach {};
struct Known {};
struct Number {};
struct Phase {};
struct Finish {};
struct Finder {};
struct Ended {};
struct Servo {};
struct Gains {};
struct Request {};
struct Parameter {};
struct Batch {};
struct Gate {};
struct Switches {};
struct Stage {};
struct Recipe {};
struct Instant {};
struct Budget {};
struct Weights {};
struct Controller {};
struct Plan {};
struct Input {};
struct Output {};
struct Memory {};
struct Settings {};
struct Configuration {};
struct Matrix {};
struct Vector {};

// Verbs: functions and templates.
template <class X>
static int as(const X&) {
  return 1;
}
template <int I, class X>
static int over(const X&, const X&) {
  return I;
}
static int at(double) {
  return 3;
}

TEST_CASE("using namespace skinctl: common names stay the user's") {
  const Task task{};
  const Text text{};
  const Model model{};
  static_cast<void>(model);
  CHECK(as<Task>(task) == 1);
  CHECK(over<2>(text, text) == 2);
  CHECK(at(0.5) == 3);
  CHECK(std::is_empty_v<Goal>);
  CHECK((std::is_empty_v<Share> && std::is_empty_v<Role> && std::is_empty_v<Mode> && std::is_empty_v<Reach>));
  CHECK((std::is_empty_v<Known> && std::is_empty_v<Number> && std::is_empty_v<Phase> &&
         std::is_empty_v<Finish> && std::is_empty_v<Finder> && std::is_empty_v<Ended>));
  CHECK((std::is_empty_v<Servo> && std::is_empty_v<Gains> && std::is_empty_v<Request> &&
         std::is_empty_v<Parameter> && std::is_empty_v<Batch> && std::is_empty_v<Gate>));
  CHECK((std::is_empty_v<Switches> && std::is_empty_v<Stage> && std::is_empty_v<Recipe> &&
         std::is_empty_v<Instant> && std::is_empty_v<Budget> && std::is_empty_v<Weights> &&
         std::is_empty_v<Controller>));
  CHECK((std::is_empty_v<Plan> && std::is_empty_v<Input> && std::is_empty_v<Output> &&
         std::is_empty_v<Memory> && std::is_empty_v<Settings> && std::is_empty_v<Configuration> &&
         std::is_empty_v<Matrix> && std::is_empty_v<Vector>));
}

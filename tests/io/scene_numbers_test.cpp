// Promise: a number of a scene that a file gives is taken, or refused with its line; a name that nobody
// asked for is refused
// Tried: names twice or misspelt, commas, NaN, too many numbers, too large for a float

#include "skinctl/io/scene_numbers.hpp"

#include <doctest/doctest.h>

#include <array>
#include <filesystem>
#include <fstream>

#include "skinctl/core/joint.hpp"

using namespace skinctl;

TEST_CASE("SceneNumbers: what the file names changes, all else stays") {
  SceneNumbers numbers(
      "# a scene\r\nskin.force = 25.5 # N/m\r\n\n  delay=12.5\nspeed = 1 2 3\nstiffness = 4\ngain = -1e-3");
  double force = 20, damping = 4;
  float gain = 0;
  Nanoseconds delay = 8ms;
  JointVelocity<3> speed{}, other = JointVelocity<3>::constant(7);
  std::array<double, 2> stiffness{1, 1};
  numbers.set("skin.force", force);
  numbers.set("damping", damping);
  numbers.set("gain", gain);
  numbers.set("delay", delay);
  numbers.set("speed", speed, 3);
  numbers.set("other", other, 3);
  numbers.set("stiffness", stiffness, 2);
  numbers.finish();
  CHECK(force == 25.5);
  CHECK(damping == 4);
  CHECK(gain == -1e-3f);
  CHECK(delay == 12'500us);
  CHECK((speed[0] == 1 && speed[1] == 2 && speed[2] == 3));
  CHECK(other[2] == 7);
  CHECK((stiffness[0] == 4 && stiffness[1] == 4));
}

TEST_CASE("SceneNumbers: what cannot be meant is refused with its line") {
  const auto ask = [](const char* text) {
    SceneNumbers numbers(text, "scene.txt");
    double a = 0;
    std::array<double, 3> b{};
    float c = 0;
    Nanoseconds d{};
    numbers.set("a", a);
    numbers.set("b", b, 3);
    numbers.set("c", c);
    numbers.set("d", d);
    numbers.finish();
  };
  const auto refused = [&](const char* text, const char* why) {
    CAPTURE(text);
    CHECK_THROWS_WITH_AS(ask(text), why, ConfigurationError);
  };
  refused("a", "skinctl: scene.txt:1: name = number expected");
  refused("\n = 1", "skinctl: scene.txt:2: name = number expected");
  refused("a =", "skinctl: scene.txt:1: a: a number is missing");
  refused("a = 1\nb = 2\na = 3", "skinctl: scene.txt:3: a: it stands in line 1");
  refused("a = 1,5", "skinctl: scene.txt:1: a: \"1,5\" is no finite number");
  refused("a = nan", "skinctl: scene.txt:1: a: \"nan\" is no finite number");
  refused("a = 1e999", "skinctl: scene.txt:1: a: \"1e999\" is no finite number");
  refused("a = 1 2", "skinctl: scene.txt:1: a: 2 numbers, expected: 1");
  refused("b = 1 2", "skinctl: scene.txt:1: b: 2 numbers, expected: 3");
  refused("c = 1e300", "skinctl: scene.txt:1: c: too large for a float");
  refused("d = 1e300", "skinctl: scene.txt:1: d: allowed: less than 1e9 ms");
  refused("a = 1\nforse = 2", "skinctl: scene.txt:2: forse: no number of this scene");
  CHECK_THROWS_WITH_AS(static_cast<void>(SceneNumbers::of_file("/no/such/file")),
                       "skinctl: /no/such/file: cannot be read", ConfigurationError);
}

TEST_CASE("SceneNumbers: a file is read") {
  const auto path = std::filesystem::temp_directory_path() / "skinctl_scene_numbers.txt";
  std::ofstream(path) << "a = 3\n";
  double a = 0;
  SceneNumbers numbers = SceneNumbers::of_file(path.string());
  numbers.set("a", a);
  numbers.finish();
  CHECK(a == 3);
  std::filesystem::remove(path);
}

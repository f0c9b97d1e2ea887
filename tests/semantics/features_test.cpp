#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "skinctl/core/real_time.hpp"
#include "skinctl/semantics/recogniser.hpp"
#include "skinctl/testing/allocation_guard.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {
/// The word of an instant by rules; in hand and carried, or let go and not left, are their memory.
Activity word_of(const Features& f) {
  if (!f.known) return Activity::unknown;
  if (f.in_hand)
    return f.squeezed           ? Activity::squeeze
           : f.tool && f.moving ? Activity::use
           : f.moving           ? Activity::put
           : f.carried          ? Activity::hold
                                : Activity::take;
  return !f.left ? Activity::release : f.moving ? Activity::reach : Activity::idle;
}
/// A tree that has learnt these rules.
const Recogniser& recogniser() {
  static const Recogniser taught([] {
    std::vector<Example<feature_numbers>> examples;
    for (unsigned bits = 0; bits < 64; ++bits) {
      Features f;
      f.known = true;
      f.moving = bits & 1, f.in_hand = bits & 2, f.carried = bits & 4;
      f.squeezed = bits & 8, f.tool = bits & 16, f.left = bits & 32;
      for (int k = 0; k < 8; ++k) examples.push_back(example(f, word_of(f)));
    }
    return ActivityTree::learn(examples);
  }());
  return taught;
}
/// A hand without noise, of which a test says what it does; it stops between its motions.
class Story {
 public:
  explicit Story(Nanoseconds period = 4ms, std::uint64_t tools = 0) : period_(period) {
    FeatureSettings s;
    s.tools = tools;
    extractor_ = FeatureExtractor<>(s);
    static_cast<void>(recogniser());  // learnt before the loop
    place(0, {0.5, 0, 0});
    place(1, {0.5, 0.5, 0});
  }
  void place(std::uint8_t object, const Xyz<double>& p) {
    static_cast<void>(world_.detect(objects_, {.object = object,
                                               .X_WO = ObjectPose<>::translation_xyz(p.x, p.y, p.z),
                                               .sigma = 0.005,
                                               .time = t_ + 1ns}));
  }
  Story& wait(Nanoseconds time) { return to(p_, time); }
  Story& press(double force) {
    force_ = force;
    return *this;
  }
  /// In a straight line with constant speed.
  Story& to(const Xyz<double>& goal, Nanoseconds time) {
    const Xyz<double> from = p_;
    const Nanoseconds end = t_ + time, begin = t_;
    while (t_ < end) {
      t_ += period_;
      const double u = std::min(1.0, seconds<double>(t_ - begin) / seconds<double>(time));
      p_ = from + u * Xyz<double>(goal - from);
      sample();
    }
    return *this;
  }
  void sample() {
    HandSample<> hand{t_, Transform<World, Tool>::translation_xyz(p_.x, p_.y, p_.z), sigma, force_};
    const AllocationGuard guard;
    const RealTimeScope loop;
    features = extractor_.step(memory_, world_, objects_, hand);
    said = recogniser().step(words_, features);
  }
  [[nodiscard]] std::string word() const { return describe(said.activity); }

  double sigma = 0.0002;
  Features features;
  Recognised said;
  ObjectWorld<2> world_{{7, 8}};
  ObjectWorld<2>::Memory objects_ = world_.start();

 private:
  FeatureExtractor<> extractor_{};
  FeatureExtractor<>::Memory memory_{};
  Recogniser::Memory words_{};
  Nanoseconds period_, t_ = 1s;
  Xyz<double> p_{0, 0, 0.3};
  double force_ = 0;
};
}  // namespace

TEST_CASE(
    "Features and rules: an orange is reached, taken, held, squeezed, put and released, at every rate") {
  for (const auto period : {1ms, 2ms, 4ms, 10ms}) {
    CAPTURE(period.count());
    Story s(period);
    s.wait(300ms);
    CHECK(s.word() == "idle");
    s.to({0.5, 0, 0}, 1s);
    CHECK(s.word() == "reach");
    s.wait(300ms);
    CHECK(s.word() == "idle");
    s.press(3).wait(200ms);
    CHECK(s.word() == "take");
    CHECK((s.features.held == 0 && s.features.held_kind == 7));
    s.to({0.5, 0, 0.2}, 500ms);
    CHECK(s.word() == "put");
    s.wait(300ms);
    CHECK(s.word() == "hold");
    s.press(6).wait(100ms);
    CHECK(s.word() == "squeeze");
    s.press(3).wait(100ms);
    CHECK(s.word() == "hold");
    s.to({0.2, 0, 0.2}, 700ms).press(0).wait(40ms);
    CHECK(s.word() == "release");
    CHECK(s.objects_.held == no_object);
    CHECK(s.objects_.objects[0].X_WO.origin().x == doctest::Approx(0.2).epsilon(0.05));
    s.to({0.2, 0, 0.3}, 300ms);
    CHECK(s.word() == "release");  // heading for nothing
    s.wait(300ms);
    CHECK(s.word() == "idle");  // stopped after more than 20 mm
    CHECK(s.said.sure);
  }
}

TEST_CASE("Features: a hand leaves by stopping, by heading for another object, or after a while") {
  const auto released = [] {
    Story s;
    s.to({0.5, 0, 0}, 1s)
        .wait(200ms)
        .press(3)
        .wait(200ms)
        .to({0.5, 0, 0.1}, 400ms)
        .wait(200ms)
        .press(0)
        .wait(60ms);
    CHECK(s.word() == "release");
    return s;
  };
  auto s = released();
  s.wait(1300ms);
  CHECK(s.word() == "release");
  s.wait(300ms);
  CHECK(s.word() == "idle");
  s = released();
  s.to({0.5, 0.055, 0.09}, 300ms);  // to the other one, not yet 60 mm away
  CHECK(s.word() == "release");
  s.to({0.5, 0.08, 0.084}, 100ms);
  CHECK(s.word() == "reach");
}

TEST_CASE("Features: a tool near another object is used, and the use has a name") {
  Story s(4ms, std::uint64_t(1) << 7);
  s.to({0.5, 0, 0}, 1s).wait(200ms).press(3).wait(200ms).to({0.5, 0.2, 0.1}, 600ms);
  CHECK(s.word() == "put");
  s.to({0.5, 0.42, 0.05}, 600ms);
  CHECK(s.word() == "use a tool");
  const ToolUse uses[] = {{7, 9, "pour"}, {7, 8, "cut"}};
  CHECK(std::string(describe_use(s.features, uses)) == "cut");
  s.wait(200ms);
  CHECK(s.word() == "hold");
}

TEST_CASE("Features: signals that do not suffice are unknown, never wrong") {
  SUBCASE("a hand that only a camera sees") {
    const FeatureExtractor<> extractor;
    CHECK(extractor.suffices(0.0002, 4ms));
    CHECK(extractor.suffices(0.0002, 1ms));
    CHECK_FALSE(extractor.suffices(0.005, 33ms));
    CHECK_FALSE(extractor.suffices(0.002, 16ms));
    Story s(33ms);
    s.sigma = 0.005;
    s.to({0.5, 0, 0}, 1s).press(3).wait(300ms);
    CHECK(s.word() == "unknown");
    CHECK_FALSE(s.said.sure);
  }
  SUBCASE("a hand without fingers that feel") {
    Story s;
    s.press(std::numeric_limits<double>::quiet_NaN()).to({0.5, 0, 0}, 1s);
    CHECK(s.word() == "unknown");
    s.press(0).wait(300ms);
    CHECK(s.word() == "idle");
  }
  SUBCASE("a hand that was not seen for a while, or a sample that is none") {
    const FeatureExtractor<> extractor;
    const ObjectWorld<1> world({1});
    auto objects = world.start();
    FeatureExtractor<>::Memory m;
    HandSample<> hand{};
    for (int k = 0; k < 100; ++k) {
      hand.time = 4ms * k;
      static_cast<void>(extractor.step(m, world, objects, hand));
    }
    CHECK(m.last.known);
    hand.time += 150ms;
    CHECK_FALSE(extractor.step(m, world, objects, hand).known);
    for (int k = 0; k < 100; ++k) {
      hand.time += 4ms;
      static_cast<void>(extractor.step(m, world, objects, hand));
    }
    CHECK(m.last.known);
    CHECK(extractor.step(m, world, objects, hand).known);  // the same again
    auto wrong = hand;
    wrong.time += 4ms;
    wrong.X_WH = Transform<World, Tool>::trusted({}, {std::numeric_limits<double>::quiet_NaN(), 0, 0});
    CHECK_FALSE(extractor.step(m, world, objects, wrong).known);
    CHECK(m.last.time == hand.time);
  }
}

TEST_CASE("Recogniser: a tree learns rules from their words") {
  for (unsigned bits = 0; bits < 64; ++bits) {
    Features f;
    f.known = true;
    f.moving = bits & 1, f.in_hand = bits & 2, f.carried = bits & 4;
    f.squeezed = bits & 8, f.tool = bits & 16, f.left = bits & 32;
    Recogniser::Memory m;
    CHECK(recogniser().step(m, f).activity == word_of(f));
  }
}

TEST_CASE("Recogniser: a word dates from its event, and is sure when it has stood for a while") {
  Story s;
  s.wait(500ms);
  CHECK(s.said.sure);
  const Nanoseconds begins = s.features.time;
  s.to({0.5, 0, 0}, 1s);
  CHECK(s.word() == "reach");
  CHECK(std::abs(seconds<double>(s.said.since - begins)) < 0.04);  // decided 40 to 60 ms later
  s.wait(200ms).press(3);
  const Nanoseconds pressed = s.features.time;
  int cycles = 0;
  while (s.word() != "take" && ++cycles < 20) s.wait(4ms);
  CHECK(cycles <= 5);
  CHECK_FALSE(s.said.sure);
  CHECK(std::abs(seconds<double>(s.said.since - pressed)) < 0.005);
  s.wait(60ms);
  CHECK(s.said.sure);
  CHECK_THROWS_AS(Recogniser(recogniser().tree(), -1ns), ConfigurationError);
}

TEST_CASE("Features: a wrong number is refused") {
  const auto refuses = [](auto change) {
    FeatureSettings s;
    change(s);
    CHECK_THROWS_AS(FeatureExtractor<>{s}, ConfigurationError);
  };
  CHECK_NOTHROW(FeatureExtractor<>{});
  refuses([](auto& s) { s.moving.off = 0; });
  refuses([](auto& s) { s.in_hand.off = 0; });
  refuses([](auto& s) { s.squeezed.off = 1; });
  refuses([](auto& s) { s.carried = 0; });
  refuses([](auto& s) { s.tool_far = 0.1; });
  refuses([](auto& s) { s.heading = 1.5; });
  refuses([](auto& s) { s.left_after = 0ns; });
  refuses([](auto& s) { s.max_gap = 0ns; });
  refuses([](auto& s) { s.force_filter = 0ns; });
}

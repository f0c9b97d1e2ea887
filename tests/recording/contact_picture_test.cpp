#include "skinctl/recording/contact_picture.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace skinctl;

namespace {

/// Four cells in a row on link 0, two on link 1, looking along z; 28 mm apart.
PressedCells skin() {
  PressedCells out;
  for (std::uint32_t i = 0; i < 6; ++i) {
    out.places.push_back({i / 4, i / 4, {0.028 * (i % 4), 0.0, 0.05}, {0.0, 0.0, 1.0}});
    out.ids.push_back(10 + i);
  }
  out.threshold = 0.5;
  return out;
}
CellSample sample(std::uint32_t id, float reading) {
  return {.time = 1ms, .cell = id, .force = {reading, 0, 0}};
}
/// Link 1 is turned about x by 90 degrees, and one metre away.
const std::vector<LinkPlace> links = {{}, {{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}}, {0, 0, 1}}};

}  // namespace

TEST_CASE(
    "ContactPicture: neighbours that are pressed are one contact, at their centre of pressure in the base") {
  ContactPicture picture(skin(), 20);
  for (std::uint32_t id = 10; id < 16; ++id) picture.take(sample(id, 0.02f));  // the rest
  CHECK(picture.find(1ms, links).empty());
  picture.take(sample(11, 0.12f));  // 2 N
  picture.take(sample(12, 0.32f));  // 6 N
  picture.take(sample(15, 0.22f));  // 4 N
  const auto found = picture.find(2ms, links);
  REQUIRE(found.size() == 2);
  const auto& near = found[found[0].link == 0 ? 0 : 1];
  const auto& far = found[found[0].link == 0 ? 1 : 0];
  CHECK(near.position[0] == doctest::Approx(0.028 * (2 * 1 + 6 * 2) / 8));
  CHECK(near.position[2] == doctest::Approx(0.05));
  CHECK(near.force[2] == doctest::Approx(-8));
  CHECK(near.area == doctest::Approx(2 * 0.8660254 * 0.028 * 0.028));
  // Its z axis is the base's -y.
  CHECK(far.link == 1);
  CHECK(far.position[0] == doctest::Approx(0.028));
  CHECK(far.position[1] == doctest::Approx(-0.05));
  CHECK(far.position[2] == doctest::Approx(1));
  CHECK(far.force[1] == doctest::Approx(4));
  CHECK(far.force[2] == doctest::Approx(0));
}

TEST_CASE("ContactPicture: a lower reading is the new rest; nonsense and unknown cells press nothing") {
  ContactPicture picture(skin(), 20);
  picture.take(sample(10, 0.1f));
  CHECK(picture.find(1ms, links).empty());  // nobody knows better
  picture.take(sample(10, 0.0f));
  picture.take(sample(10, 0.1f));
  REQUIRE(picture.find(2ms, links).size() == 1);
  CHECK(picture.find(3ms, {}).empty());  // no link is known
  picture.take(sample(10, 0.0f));
  picture.take(sample(11, std::numeric_limits<float>::quiet_NaN()));
  picture.take(sample(99, 1));
  CHECK(picture.find(4ms, links).empty());
}

TEST_CASE("ContactPicture: what cannot be is refused at construction") {
  auto few = skin();
  few.ids.pop_back();
  CHECK_THROWS_WITH_AS(ContactPicture(few, 20), doctest::Contains("one for each cell"), ConfigurationError);
  PressedCells many;
  for (std::uint32_t i = 0; i < 8193; ++i) {
    many.places.push_back({0, 0, {0.03 * i, 0.0, 0.0}, {0.0, 0.0, 1.0}});
    many.ids.push_back(i);
  }
  CHECK_THROWS_WITH_AS(ContactPicture(many, 20), doctest::Contains("at most 8192"), ConfigurationError);
}

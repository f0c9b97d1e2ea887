#include "skinctl/robots/ur5_skin.hpp"

#include <doctest/doctest.h>

#include <array>
#include <set>
#include <vector>

#include "tests/support/random_skin.hpp"

using namespace skinctl;
using namespace skinctl::testing;

static_assert(Ur5Skin<260>::cells == 260 && Ur5Skin<1260>::cells == 1260 && Ur5Skin<10000>::cells == 10000);
static_assert(Ur5Skin<260>::links == 0b111111);

TEST_CASE("ur5_skin: TUM's cells up to 383 of them, smaller ones beyond, ids from 1 on") {
  for_each_index<6>([](auto i) {
    CHECK(ur5::room[i.value] == full_cover(ur5::surface<i.value>()).size());
    CHECK(largest_cell(ur5::surface<i.value>(), ur5::skin_cells<260>[i.value]).scale == 1);
    CHECK(largest_cell(ur5::surface<i.value>(), ur5::skin_cells<383>[i.value]).scale == 1);
    const double of_1260 = largest_cell(ur5::surface<i.value>(), ur5::skin_cells<1260>[i.value]).scale;
    CHECK(of_1260 > 0.5);
    CHECK(of_1260 < 0.75);
    const double of_10000 = largest_cell(ur5::surface<i.value>(), ur5::skin_cells<10000>[i.value]).scale;
    CHECK(of_10000 > 0.19);
    CHECK(of_10000 < 0.3);
  });
  const auto check_ids = []<std::size_t Cells>() {
    std::set<std::uint32_t> ids;
    std::size_t total = 0;
    std::apply(
        [&](const auto&... patch) {
          ((total += patch.placed().size()), ...);
          const auto note = [&](const auto& p) {
            for (const auto& cell : p.placed()) ids.insert(cell.id);
          };
          (note(patch), ...);
        },
        ur5::skin_patches<Cells>());
    CHECK(total == Cells);
    CHECK(ids.size() == Cells);
    CHECK(*ids.begin() == 1);
    CHECK(*ids.rbegin() == Cells);
  };
  check_ids.template operator()<6>();
  check_ids.template operator()<260>();
  check_ids.template operator()<1260>();
  check_ids.template operator()<10000>();
}

TEST_CASE("ur5_skin: cells stand on the tubes and look away from their axes") {
  std::apply(
      [](const auto&... patch) {
        const auto check = []<std::size_t I, std::size_t N>(const Patch<I, N>& p) {
          const ur5::Tube& tube = ur5::tubes[I];
          const Xyz<double> along = tube.to - tube.from;
          const double length = norm(along);
          for (const auto& cell : p.placed()) {
            const Xyz<double> from_end = cell.X_LC.origin() - tube.from;
            const double height = dot(from_end, along) / length;
            CHECK(height > 0);
            CHECK(height < length);
            const Xyz<double> radial = from_end - (height / length) * along;
            CHECK(norm(radial) == doctest::Approx(tube.radius).epsilon(1e-9));
            CHECK(norm(radial - tube.radius * cell.X_LC.axis_z()) <= 1e-12);
          }
        };
        (check(patch), ...);
      },
      ur5::skin_patches<260>());
}

TEST_CASE("ur5_skin: builds for every scalar and every model of the topology, with the user's settings") {
  SkinSettings settings;
  settings.max_age = 90ms;
  const auto skin = ur5_skin<1260, float, ur5::Calibrated<float>>({5, 1}, settings);
  CHECK(skin.settings().max_age == 90ms);
  CHECK(skin.index(1) == 0);
  CHECK(skin.index(1260) == 1259);
  CHECK(skin.index(0) == 1260);
  CHECK(skin.index(1261) == 1260);
  CHECK(skin.silent(skin.start(0ns)) == 1260);
}

TEST_CASE("ur5_skin: an array of gains gives each link its own") {
  const auto same = ur5_skin<260>({20, 0});
  const auto own =
      ur5_skin<260>(std::array<CellGains, 6>{{{20, 0}, {40, 0}, {60, 0}, {0, 0}, {10, 0}, {30, 0}}});
  const double factor[6] = {1, 2, 3, 0, 0.5, 1.5};
  std::vector<CellSample> samples;
  for (std::uint32_t id = 1; id <= 260; ++id)
    samples.push_back({.time = 1ms, .cell = id, .force = {0.1f, 0.1f, 0.1f}});
  const auto pushed = [&](const auto& skin) {
    auto memory = skin.start(0ns);
    typename std::remove_cvref_t<decltype(skin)>::Wrenches means[1];
    skin.receive(memory, samples, 0ns, 8ms, 1, means);
    return skin.wrenches(memory);
  };
  const auto a = pushed(same), b = pushed(own);
  for_each_index<6>([&](auto i) {
    CAPTURE(i.value);
    const auto F = a.template wrench<i.value>(), G = b.template wrench<i.value>();
    CHECK(norm(F.force) > 0.1);
    CHECK(norm(G.force - factor[i.value] * F.force) <= 1e-12 * norm(F.force));
    CHECK(norm(G.moment - factor[i.value] * F.moment) <= 1e-12);
  });
}

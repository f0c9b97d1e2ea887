// Pads of other makers on an arm, from the skin files of examples/data.

#include "examples/adapters/skin/pads.hpp"

#include <doctest/doctest.h>

#include "examples/adapters/skin/any_skin.hpp"
#include "examples/adapters/skin/tf_luna.hpp"
#include "examples/adapters/skin/xela.hpp"
#include "skinctl/io/skin_file.hpp"
#include "skinctl/io/urdf.hpp"
#include "skinctl/tactile/skin_of.hpp"

using namespace skinctl;
using namespace adapters::skin;

namespace {

using Arm = CalibratedModel<Chain<7>>;
template <class Kind>
using Pads = SkinOf<Arm, double, 16, 2, all_links(7), Kind>;

const Urdf& arm() {
  static const Urdf urdf = read_urdf(EXAMPLES_DATA "/arm7.urdf", {.tip = "hand_link"});
  return urdf;
}
template <class Kind>
auto pushed(const Pads<Kind>& skin, const std::vector<SensorSample<Kind>>& samples) {
  auto memory = skin.start(0ns);
  typename Pads<Kind>::Wrenches mean;
  CHECK(skin.receive(memory, std::span(samples), 0ns, 10ms, 1, &mean) == Status{});
  return skin.wrenches(memory);
}

}  // namespace

TEST_CASE("Pads: XELA's module of the file pushes the hand as one press, and its corner with a moment") {
  const SkinFile file = read_skin_file(EXAMPLES_DATA "/xela_skin.json");
  const auto placed = place_skin(file, arm());
  ChannelSettings<XelaForces> settings;
  settings.gate.fill(EventGate<>());
  const Pads<XelaForces> skin(pads_of<XelaForces>(file, placed), settings);
  REQUIRE(skin.size() == 16);
  const auto taxel = [&](std::uint32_t k, float z) {
    return SensorSample<XelaForces>{.time = 5ms, .cell = xela_cell(1, k), .readings = {0, 0, z}};
  };
  std::vector<SensorSample<XelaForces>> all, one;
  for (std::uint32_t k = 0; k < 16; ++k)
    all.push_back(taxel(k, 0.5f)), one.push_back(taxel(k, k == 0 ? 8.0f : 0));
  const auto flat = pushed(skin, all), corner = pushed(skin, one);
  const Xyz<double> f{flat.data[6][0], flat.data[6][1], flat.data[6][2]};
  CHECK(norm(f) == doctest::Approx(8).epsilon(1e-3));
  Xyz<double> moved;
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(corner.data[6][k] == doctest::Approx(flat.data[6][k]).epsilon(1e-3));
    (k == 0 ? moved.x : k == 1 ? moved.y : moved.z) = corner.data[6][3 + k] - flat.data[6][3 + k];
  }
  CHECK(norm(moved) ==
        doctest::Approx(8 * 1.5 * 0.0047 * std::sqrt(2.0)).epsilon(2e-3));  // 1.5 pitches each way
}

TEST_CASE("Pads: an AnySkin of the file is one cell, whose forces its calibration makes") {
  const SkinFile file = read_skin_file(EXAMPLES_DATA "/any_skin.json");
  ChannelCalibration<AnySkin> calibration;
  calibration.A[0][3] = 0.01f;  // of the field along z of the middle chip
  calibration.b[0] = -1;
  ChannelSettings<AnySkin> settings;
  settings.gate.fill(EventGate<>());
  const auto skin =
      calibrated(Pads<AnySkin>(pads_of<AnySkin>(file, place_skin(file, arm())), settings), {calibration});
  REQUIRE(skin.size() == 1);
  SensorSample<AnySkin> s{.time = 5ms, .cell = 0, .readings = {}};
  s.readings[3] = 700;
  const auto w = pushed(skin, std::vector{s});
  CHECK(norm(Xyz<double>{w.data[6][0], w.data[6][1], w.data[6][2]}) == doctest::Approx(6).epsilon(1e-3));
}

TEST_CASE("Pads: gains and masks of a file are those of its cells") {
  SkinFile file = read_skin_file(EXAMPLES_DATA "/xela_skin.json");
  file.patches[0].gains.force = 2;
  file.patches[0].cells[3].gain = 0.5;
  file.patches[0].cells[4].masked = "broken";
  const auto pads = pads_of<XelaForces>(file, place_skin(file, arm()));
  REQUIRE(pads.size() == 1);
  CHECK(pads[0].link == 6);
  CHECK(pads[0].gains.channel == std::array{2.0, 2.0, 2.0});
  CHECK(pads[0].cells[3].gains->channel == std::array{1.0, 1.0, 1.0});
  CHECK_FALSE(pads[0].cells[2].gains.has_value());
  CHECK(pads[0].cells[4].masked);
  CHECK_FALSE(pads[0].cells[5].masked);
}

TEST_CASE("Pads: a TF-Luna of the file pushes the forearm away from what it sees, and from nothing else") {
  const SkinFile file = read_skin_file(EXAMPLES_DATA "/tf_luna_skin.json");
  const auto placed = place_skin(file, arm());
  ChannelSettings<TfLuna> settings;
  settings.gate.fill(EventGate<>());
  const Pads<TfLuna> skin(pads_of<TfLuna>(file, placed), settings);
  REQUIRE(skin.size() == 1);
  const auto sees = [&](std::uint16_t centimetres, std::uint16_t strength) {
    const std::vector<SensorSample<TfLuna>> samples = {
        {.time = 5ms, .cell = 0, .readings = TfLunaFrame{centimetres, strength, 2200}.readings()}};
    const auto w = pushed(skin, samples);
    double most = 0;
    for (const auto& link : w.data) most = std::max(most, norm(Xyz<double>{link[0], link[1], link[2]}));
    return most;
  };
  CHECK(sees(60, 900) == doctest::Approx(15 * 0.5).epsilon(1e-3));  // the file's gain of proximity
  CHECK(sees(20, 900) == doctest::Approx(15).epsilon(1e-3));
  CHECK(sees(150, 900) == 0);
  CHECK(sees(60, 50) == 0);
}

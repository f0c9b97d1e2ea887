// 28 Follow a contact: a hand slides along an arm, a second one joins; each keeps its identity.
//
//   drawn  place of each contact along the forearm as felt and as it is, its push, the force of a region
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/tactile/contact_skin.hpp"
#include "skinctl/testing/pressing.hpp"
#include "support/arm.hpp"

using namespace examples;
using skinctl::testing::Pressing;

namespace {
/// On top of the forearm's tube, `x` [m] from the link's origin.
Pressing hand_at(double x, double force) {
  return {2, {x, 0.0, 0.0565}, {0.0, 0.0, 1.0}, 0.045, force};
}
}  // namespace

int main(int argc, char** argv) {
  const auto cells = ur5_skin<383>(CellGains{10, 0}, {.force = EventGate<>::dead_band(0.01)});
  Region elbow{.name = "elbow", .cells = {}, .weight = 1, .force_limit = 60};
  const auto places = cells.places();
  for (std::size_t i = 0; i < places.size(); ++i)
    if (places[i].link == 2 && places[i].place.x > -0.13) elbow.cells.push_back(std::uint32_t(i + 1));
  const ContactSkin skin(cells, Regions{elbow});
  const auto memory = std::make_unique<decltype(skin)::Memory>(skin.start(0ns));

  Curve first{"contact 1"}, second{"contact 2"}, hand_1{"hand 1"}, hand_2{"hand 2"};
  Curve push_1{"contact 1"}, push_2{"contact 2"}, region{"elbow"};
  hand_1.dashed = hand_2.dashed = true;
  std::uint32_t most_ids = 0;
  double worst = 0;
  for (Nanoseconds now = 8ms; now <= 8s; now += 8ms) {
    const double t = seconds<double>(now);
    // The first hand slides to the elbow and back; the second one holds the wrist's end for a while.
    const double x_1 = -0.13 + 0.04 * std::sin(1.6 * t), x_2 = -0.3;
    const bool joins = t > 3 && t < 6;
    std::vector<Pressing> hands{hand_at(x_1, 15)};
    if (joins) hands.push_back(hand_at(x_2, 8));
    const auto samples =
        skinctl::testing::pushed_samples(skinctl::testing::pushes(places, hands), 10, now - 1ms);
    decltype(skin)::Wrenches mean;
    static_cast<void>(skin.receive(*memory, samples, now - 8ms, now, 1, &mean));

    hand_1.add(t, 1e3 * x_1);
    if (joins) hand_2.add(t, 1e3 * x_2);
    for (const auto& c : skin.contacts(*memory)) {
      most_ids = std::max(most_ids, c.id);
      (c.id == 1 ? first : second).add(t, 1e3 * c.place.x);
      (c.id == 1 ? push_1 : push_2).add(t, c.pushed);
      worst = std::max(worst, std::abs(c.place.x - (c.id == 1 ? x_1 : x_2)));
    }
    region.add(t, skin.region_force(*memory, 0));
  }
  std::printf("two hands, %u identities; centre of pressure along the arm within %.1f mm\n", most_ids,
              1e3 * worst);
  return draw(argc, argv, "28_follow_a_contact.svg", "Two hands on an arm: each contact keeps its identity",
              {Panel("along the forearm [mm]", {first, second, hand_1, hand_2}),
               Panel("push [N]", {push_1, push_2}), Panel("force of a region [N]", {region})},
              while_above_zero(push_2, "second hand")) ||
         most_ids != 2 || worst > 0.01;
}

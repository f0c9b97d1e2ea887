// Promise: a model is the same robot as the URDF of it
// Tried: UR3 to UR10e, Allegro hands, an arm with a hand: torque to 1e-12, origins to 1e-13 m

#include "skinctl/io/urdf_writer.hpp"

#include <doctest/doctest.h>

#include <random>

#include "skinctl/io/urdf.hpp"
#include "skinctl/skinctl.hpp"
#include "tests/support/comma_locale.hpp"

using namespace skinctl;

namespace {

/// A model, and the URDF of it read again, have the same torques and the links' origins at the same places.
/// `Tree` has the model's joints: the comparison is compiled once for robots of one tree.
template <class Tree, class M>
void check_round_trip(const char* name, const M& given) {
  CAPTURE(name);
  const Urdf urdf = parse_urdf(urdf_text(given));
  REQUIRE(urdf.joints.size() == M::joints);
  const auto gravity = given.template gravity<double>();
  const Xyz<double> g{double(gravity.x), double(gravity.y), double(gravity.z)};
  typename CalibratedModel<Tree>::Links links;
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    ((links[I] = numbers_of<I, double>(given)), ...);
  }(std::make_index_sequence<M::joints>());
  const CalibratedModel<Tree> model(links, g, makers_density);
  const auto again = calibrated_from<Tree>(urdf, g);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-3, 3);
  for (int k = 0; k < 20; ++k) {
    JointPosition<M::joints> q;
    JointVelocity<M::joints> dq;
    JointAcceleration<M::joints> ddq;
    for (std::size_t i = 0; i < M::joints; ++i) q[i] = any(random), dq[i] = any(random), ddq[i] = any(random);
    const auto tau = inverse_dynamics(model, q, dq, ddq), same = inverse_dynamics(again, q, dq, ddq);
    double most = 1;
    for (std::size_t i = 0; i < M::joints; ++i) most = std::max(most, std::abs(tau[i]));
    for (std::size_t i = 0; i < M::joints; ++i) CHECK(std::abs(tau[i] - same[i]) <= 1e-12 * most);
    const auto a = link_poses(model, q), b = link_poses(again, q);
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      double apart = 0;
      ((apart =
            std::max(apart, norm(Xyz<double>(a.template get<I>().origin() - b.template get<I>().origin())))),
       ...);
      CHECK(apart <= 1e-13);
    }(std::make_index_sequence<M::joints>());
  }
}

}  // namespace

TEST_CASE("URDF writer: every robot that is shipped comes back with the same motion and torque") {
  check_round_trip<Chain<6>>("UR5", ur5::Model{});
  check_round_trip<Chain<6>>("UR3", ur3::Model{});
  check_round_trip<Chain<6>>("UR10", ur10::Model{});
  check_round_trip<Chain<6>>("UR3e", ur3e::Model{});
  check_round_trip<Chain<6>>("UR5e", ur5e::Model{});
  check_round_trip<Chain<6>>("UR10e", ur10e::Model{});
  check_round_trip<allegro::Tree>("Allegro, right", allegro::hand<double>(allegro::Side::right));
  check_round_trip<allegro::Tree>("Allegro, left", allegro::hand<double>(allegro::Side::left));
  check_round_trip<ur5_allegro::Model<>>("UR5 with an Allegro hand", ur5_allegro::arm_with_hand());
}

TEST_CASE("URDF writer: the same characters in every locale") {
  const std::string text = urdf_text(ur5::Model{});
  const testing::CommaLocale comma;
  CHECK((urdf_text(ur5::Model{}) == text));
}

TEST_CASE("URDF writer: names, limits, capsules and frames are in the file, and marks of XML are escaped") {
  UrdfDress dress;
  dress.name = "a \"robot\" & <more>";
  dress.joints = {"first"};
  dress.links = {"one", "two"};
  dress.limits.assign(6, {-1, 2, 3, 4});
  dress.capsules = {{1, {{0, 0, 0}, {0.3, 0, 0}, 0.05}}, {LinkCapsule::fixed, {{0, 0, 0}, {0, 0, 0}, 0.1}}};
  for (const NamedLink& l : ur5::Ros2Links::named_links) dress.named_links.push_back(l);
  const std::string text = urdf_text(ur5::Model{}, dress);
  const Urdf urdf = parse_urdf(text);
  CHECK(urdf.name == dress.name);
  CHECK(urdf.joints[0].name == "first");
  CHECK(urdf.joints[1].name == "joint_2");
  CHECK(urdf.joints[1].link == "two");
  CHECK(urdf.joints[3].upper == 2);
  CHECK(urdf.joints[3].effort == 4);
  CHECK(urdf.frame("tool0").joint == 5);
  // At q = 0 the model's frames may be turned about z against the file's: distances to the joints' axes stay.
  CHECK(urdf.frame("wrist_1_link").p.z == doctest::Approx(ur5::Description::d4).epsilon(1e-12));
  CHECK(text.find("<cylinder radius=\"0.05\" length=\"0.3\"/>") != std::string::npos);
  CHECK(text.find("<sphere radius=\"0.1\"/>") != std::string::npos);
  CHECK(text.find("a &quot;robot&quot; &amp; &lt;more&gt;") != std::string::npos);

  dress.limits.resize(5);
  CHECK_THROWS_AS(static_cast<void>(urdf_text(ur5::Model{}, dress)), ConfigurationError);
  dress.limits.clear();
  dress.capsules[0].link = 6;
  CHECK_THROWS_AS(static_cast<void>(urdf_text(ur5::Model{}, dress)), ConfigurationError);
}

// 35 Hold a cup: three fingertips with three-axis taxels hold a cup by shear while it is filled and pulled.
//
//   f_n, f_t  normal force and shear of a fingertip: sums over its four taxels [N]
//   mu        friction that is reckoned with: it grows until the cup slides a little, and tells it
//   hold      1.4 f_t / mu: normal force that is asked for; the grip tightens at once and loosens slowly
//   fixed     least force of a grip that feels nothing and drops the cup at neither friction
//   drawn     hand and cup, forces on the fingertips; force of the grip, demand of the thumb, way slid
#include <cstdio>
#include <memory>
#include <random>

#include "examples/support/curves.hpp"
#include "examples/support/text.hpp"
#include "examples/worlds/held_cup.hpp"
#include "skinctl/control/grasp_control.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/tactile/skin.hpp"
#include "skinctl/tactile/slip.hpp"

using namespace skinctl;
using namespace examples;
using skinctl::testing::HeldCup;

namespace {

/// A pillar of a fingertip: forces along and into its surface, in newtons.
struct Taxel {
  static constexpr std::string_view name = "my-taxel-1";
  static constexpr std::array readings{Reading{"x", -20, 20}, Reading{"y", -20, 20}, Reading{"z", 0, 20}};
  static constexpr std::array channels{
      Channel{"normal", ChannelUse::contact, 0b100, 20},
      Channel{"shear x", ChannelUse::contact, 0b001, 20, {1, 0, 0}, {}, with_normal},
      Channel{"shear y", ChannelUse::contact, 0b010, 20, {0, 1, 0}, {}, with_normal}};
};

constexpr std::size_t fingers = HeldCup::fingers, each = HeldCup::cells;
using Grip = GraspControl<16, double, 3, 7, 15>;  // index, middle, thumb
template <std::size_t L>
using Fingertip = Patch<L, each, Taxel>;

auto make_scene(const HeldCup& cup) {
  ChannelSettings<Taxel> open;
  open.gate.fill(EventGate<>());
  const Skin<HeldCup::Hand, double, Fingertip<3>, Fingertip<7>, Fingertip<15>> skin(
      Fingertip<3>(cup.skin<3>(0)), Fingertip<7>(cup.skin<7>(1)), Fingertip<15>(cup.skin<15>(2)), open);
  const JointLimits<16> limits({.lower = JointPosition<16>::constant(-1),
                                .upper = JointPosition<16>::constant(2),
                                .velocity = JointVelocity<16>::constant(7),
                                .acceleration = JointAcceleration<16>::constant(500),
                                .torque = JointTorque<16>::constant(2)});
  const auto hand = by_torque(cup.hand(), {.limits = limits, .period = 1ms, .delay = 1ms},
                              RobotHoldsGravity{}, FrictionUncompensated{});
  return Cycle(hand, skin, Grip(HeldCup::tips, {.damping = 20, .max_rate = 100, .max_force = 15}));
}

/// An instant of the hand from the side: the cup's fill, the fingertips' forces.
struct Seen {
  const char* name;
  double at, fill, pull;
  JointPosition<16> q{};
  Xyz<double> cup{0, 0, 0};
  std::array<Xyz<double>, fingers> force{};
};

struct Run {
  Curve grip, slid{"way slid [mm]"}, demand{"demand f_t / f_n"}, friction{"mu"}, filling, pulled;
  double mean = 0, most = 0;
  bool dropped = false;
  std::vector<Seen> seen;
};

/// Takes a cup of 0.2 kg, lifts it, has it filled to 0.5 kg from 4 to 12 s, pulls it by 2 N from 14 to 16 s.
/// @param fixed  force of a grip that feels nothing [N]; 0: it follows its fingertips.
Run hold(double mu, double fixed) {
  HeldCup cup(mu);
  const auto scene = make_scene(cup);
  using Scene = std::remove_const_t<decltype(scene)>;
  const auto memory = std::make_unique<Scene::Memory>();
  scene.start(*memory, cup.state());
  const Grip grip(HeldCup::tips);
  const Slip<> slip({.probe = 0.05, .noise = 0.06});  // without: heavier, and safe against any pull
  std::array<Slip<>::Memory, fingers> felt{};
  std::array<Slip<>::Result, fingers> said{};
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0, 0.03);

  Run out;
  out.grip.name = out.slid.name = text("friction %.1f", mu);
  std::vector<Seen> instants{
      {"0.2 kg", 3.9, 0.25, 0}, {"0.5 kg", 13.9, 0.85, 0}, {"pulled by 2 N", 15, 0.85, 2}};
  int carried = 0;
  for (int k = 1; k <= 18000; ++k) {
    const double t = 0.001 * k;
    const double mass = 0.2 + 0.3 * std::clamp((t - 4) / 8, 0.0, 1.0);
    const double borne = std::clamp((t - 1) / 0.5, 0.0, 1.0);  // a table bears the rest
    const double pull = t > 14 && t < 16 ? 2 * std::min(1.0, std::min(t - 14, 16 - t) / 0.1) : 0;

    std::array<SensorSample<Taxel>, fingers * each> samples;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const Xyz<double> F = cup.felt(i / each);
      const auto read = [&](double force) { return static_cast<float>(force + noise(random)); };
      samples[i] = {
          k * 1ms, static_cast<std::uint32_t>(i), {read(F.x), read(F.y), std::max(0.0f, read(F.z))}};
    }
    Scene::Input input;
    input.now = k * 1ms;
    input.measured = cup.state();
    input.measured.time = input.now;
    input.sensed.taxels = samples;
    // What the fingertips asked for in the last cycle.
    const Quantities<HeldCup::Hand, Grip::needs, double> known(cup.hand(), cup.state(), 0.001, NoTouch{});
    const auto shape = grip.shape(known);
    GraspGoal<double> goal{fixed > 0 ? fixed : 2};
    for (std::size_t f = 0; f < fingers && fixed == 0; ++f)
      goal.hold = std::max(goal.hold, grip.force_for(shape, f, said[f].hold));
    input.goal = goal;
    const auto command = scene.step(*memory, input);

    const auto w = scene.skin().wrenches(memory->skin);
    for (std::size_t f = 0; f < fingers; ++f)
      said[f] = slip.take(felt[f], 0.001, {w.data[f][0], w.data[f][1], w.data[f][2]}, -1.0 * cup.axes(f).z);
    cup.advance(0.001, command.command.torque, mass, borne, pull);

    const double force = memory->law.force;
    if (t > 1.5) out.mean += force, out.most = std::max(out.most, force), ++carried;
    if (k % 20 == 0) {
      out.grip.add(t, force), out.slid.add(t, 1e3 * cup.slid());
      out.demand.add(t, said[2].demand), out.friction.add(t, slip.friction(felt[2]));
      out.filling.add(t, t > 4 && t < 12 ? 1 : 0), out.pulled.add(t, pull);
    }
    for (const Seen& s : instants)
      if (std::abs(t - s.at) < 5e-4) {
        out.seen.push_back(s);
        out.seen.back().q = cup.state().q, out.seen.back().cup = cup.moved();
        for (std::size_t f = 0; f < fingers; ++f) out.seen.back().force[f] = cup.touch(f).force;
      }
    if (cup.slid() > 0.05) return out.dropped = true, out;
  }
  out.mean /= carried;
  return out;
}

/// Hand and cup from the side, at each instant: the weight hangs down, the thumb is on the right.
class Side {
 public:
  static constexpr double height = 250, scale = 1150, newton = 7;  ///< [px], [px/m], [px/N]

  explicit Side(const HeldCup& cup) : model_(cup.hand()), down_(cup.down()) {
    const auto at = cup.places();
    middle_ = 0.5 * Xyz<double>(0.5 * Xyz<double>(at[0] + at[1]) + at[2]);
    across_ = at[2] - 0.5 * Xyz<double>(at[0] + at[1]);
    across_ = (1 / norm(across_)) * across_;
    half_ = 0.5 * dot(Xyz<double>(at[2] - 0.5 * Xyz<double>(at[0] + at[1])), across_);
  }
  [[nodiscard]] plotting::Head draw(const std::vector<Seen>& seen) const {
    plotting::Head out;
    out.height = height + 22;
    out.style =
        ".hold path{fill:none;stroke-linecap:round;stroke-linejoin:round}.hold "
        ".link{stroke:#8c959f;stroke-width:13}"
        ".hold .palm{stroke:#afb8c1;stroke-width:22}.hold .cup{stroke:#57606a;stroke-width:3}"
        ".hold .water{fill:#54aeff;opacity:.5}.hold .press{stroke:#bf3989;stroke-width:3.5}"
        ".hold .shear{stroke:#1a7f37;stroke-width:3.5}.hold .pull{stroke:#bc4c00;stroke-width:3.5}"
        "@media(prefers-color-scheme:dark){.hold .link{stroke:#6e7681}.hold .palm{stroke:#484f58}"
        ".hold .cup{stroke:#c9d1d9}.hold .press{stroke:#f778ba}.hold .shear{stroke:#3fb950}"
        ".hold .pull{stroke:#f0883e}}";
    out.svg = "<g class=\"hold\">";
    for (std::size_t i = 0; i < seen.size(); ++i) out.svg += one(seen[i], 150 + 310 * double(i));
    out.svg += "</g><text x=\"0\" y=\"" + std::to_string(int(height) + 12) +
               "\">forces of the fingertips on a cup of friction 0.6, the index's and the middle's together: "
               "normal (pink), shear (green); pull (orange)</text>";
    return out;
  }

 private:
  using Point = std::array<double, 2>;
  [[nodiscard]] Point seen_from_side(const Xyz<double>& p) const {
    const Xyz<double> off = p - middle_;
    return {scale * dot(off, across_), scale * dot(off, down_)};
  }
  [[nodiscard]] static std::string path(const char* kind, Point origin, const std::vector<Point>& points) {
    std::string out = std::string("<path class=\"") + kind + "\" d=\"";
    for (const Point& p : points)
      out += text("%s%.1f %.1f", out.back() == '"' ? "M" : "L", origin[0] + p[0], origin[1] + p[1]);
    return out + "\"/>";
  }
  [[nodiscard]] static std::string arrow(const char* kind, Point origin, Point from, Point way) {
    const double length = std::hypot(way[0], way[1]);
    if (length < 2) return {};
    const Point to{from[0] + way[0], from[1] + way[1]}, u{way[0] / length * 6, way[1] / length * 6};
    return path(kind, origin, {from, to}) + path(kind, origin,
                                                 {{to[0] - u[0] - 0.7 * u[1], to[1] - u[1] + 0.7 * u[0]},
                                                  to,
                                                  {to[0] - u[0] + 0.7 * u[1], to[1] - u[1] - 0.7 * u[0]}});
  }
  [[nodiscard]] std::string one(const Seen& s, double x) const {
    const Point origin{x, 110};
    const Poses<HeldCup::Hand, all_links(16)> poses(model_, s.q);
    std::string out;
    const auto finger = [&]<std::size_t First>(std::integral_constant<std::size_t, First>, std::size_t f) {
      const Xyz<double>& p = HeldCup::tips[f];
      const auto tip =
          poses.template get<First + 3>() * Transform<Link<First + 3>, Tool>::translation_xyz(p.x, p.y, p.z);
      return path("link", origin,
                  {seen_from_side(poses.template get<First>().origin()),
                   seen_from_side(poses.template get<First + 1>().origin()),
                   seen_from_side(poses.template get<First + 2>().origin()),
                   seen_from_side(poses.template get<First + 3>().origin()), seen_from_side(tip.origin())});
    };
    // The cup, as it hangs.
    const double low = scale * dot(s.cup, down_), wall = scale * (half_ - 0.006);
    const double rim = low - 35, bottom = low + 95, level = bottom - s.fill * (bottom - rim);
    out += text("<rect class=\"water\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>", x - wall,
                origin[1] + level, 2 * wall, bottom - level) +
           path("cup", origin, {{-wall, rim}, {-wall, bottom}, {wall, bottom}, {wall, rim}});
    out += path("palm", origin, {seen_from_side({0, 0, 0}), seen_from_side({0, 0, -0.095})});
    out += finger(std::integral_constant<std::size_t, 12>(), 2) +
           finger(std::integral_constant<std::size_t, 4>(), 1) +
           finger(std::integral_constant<std::size_t, 0>(), 0);
    // Forces on the cup: they act against those on the fingertips.
    for (const bool thumb : {false, true}) {
      const Xyz<double> F = thumb ? s.force[2] : Xyz<double>(s.force[0] + s.force[1]);
      const Point at{thumb ? wall : -wall, low};
      out += arrow("press", origin, {at[0], low + (thumb ? 6 : -6)}, {-newton * dot(F, across_), 0});
      out += arrow("shear", origin, at, {0, -newton * dot(F, down_)});
    }
    out += arrow("pull", origin, {0, bottom + 4}, {0, 2 * newton * s.pull});
    out += std::string("<text x=\"") + std::to_string(int(x) - 120) + "\" y=\"14\">" + s.name + "</text>";
    return out;
  }

  HeldCup::Hand model_;
  Xyz<double> down_, middle_, across_;
  double half_;
};

std::vector<plotting::Band> bands_of(const Run& run) {
  auto bands = while_above_zero(run.filling, "filled");
  for (const auto& band : while_above_zero(run.pulled, "pulled")) bands.push_back(band);
  return bands;
}

}  // namespace

int main(int argc, char** argv) {
  const Run rough = hold(0.6, 0), smooth = hold(0.3, 0);
  double force = 8;
  while (hold(0.3, force).dropped) force += 0.5;
  std::printf("friction 0.6: %4.1f N on average, %4.1f N at most, slid by %.1f mm\n", rough.mean, rough.most,
              rough.slid.y.back());
  std::printf("friction 0.3: %4.1f N on average, %4.1f N at most, slid by %.1f mm\n", smooth.mean,
              smooth.most, smooth.slid.y.back());
  std::printf("a grip that feels nothing: %.1f N, or it drops one of them\n", force);
  Curve fixed{.name = "a grip that feels nothing", .dashed = true};
  for (const double t : rough.grip.t) fixed.add(t, force);
  Curve demand_rough = rough.demand, demand = smooth.demand, mu = smooth.friction;
  demand_rough.name = rough.grip.name, demand.name = smooth.grip.name;
  mu.name = "friction reckoned with, of the latter", mu.dashed = true;
  return draw(argc, argv, "35_hold_a_cup.svg",
              "A cup in three fingertips: the grip follows their shear, while it is filled and pulled",
              {Panel("force of the grip [N]", {rough.grip, smooth.grip, fixed}),
               Panel("shear / normal force, thumb", {demand_rough, demand, mu}),
               Panel("slid [mm]", {rough.slid, smooth.slid})},
              bands_of(rough), Side(HeldCup(0.6)).draw(rough.seen)) ||
         rough.dropped || smooth.dropped || rough.mean > 0.7 * force || smooth.mean > 0.95 * force ||
         smooth.slid.y.back() > 5;
}

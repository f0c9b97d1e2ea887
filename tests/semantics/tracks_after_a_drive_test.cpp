// Promise: things that were seen before a drive are looked at again after it, and found
// Tried: 12 things, drives with an odometry of 20 mm and 10 mrad, 200 seeds, float and double: each is the
// track that it was at the first picture, and is taken; not told of the drive 13 % are, 76 % would be missed

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "skinctl/semantics/tracks_from_base.hpp"
#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr ObjectClass orange = 1;
constexpr std::size_t things = 12;
constexpr auto everywhere = [](const auto&) { return true; };

Xyz<double> place(std::size_t k) {
  return {0.15 * static_cast<double>(k % 4), 0.15 * static_cast<double>(k / 4), 0.04};
}
Transform<World, Base> stands_at(double x, double y, double yaw) {
  return Transform<World, Base>::translation_xyz(x, y, 0).rotated_z(yaw);
}

struct Result {
  int same = 0, failed = 0, tracks = 0, unsure = 0, lost = 0, blind = 0;
};
/// Sees things from one side, drives round them, with 20 mm and 10 mrad of odometry, looks again, takes them.
template <class T>
Result drive(std::uint64_t seed, bool told) {
  const TracksFromBase<32, T> tracks;
  typename TracksFromBase<32, T>::Memory m;
  auto rng = seeded(seed);
  std::normal_distribution<double> unit(0, 1);
  std::array<bool, things> there;
  there.fill(true);
  Transform<World, Base> real = stands_at(-0.6, 0, 0.1);
  BaseState<T> base;
  base.X_WB = real.cast<T>();
  const auto look = [&] {
    if (told) CHECK_FALSE(tracks.drove(m, base).any());
    std::vector<ClassDetection<T>> seen;
    const auto X_BW = real.inverse();
    for (std::size_t k = 0; k < things; ++k) {
      const Xyz<double> p_B = X_BW.origin() + X_BW.axes() * place(k);
      const auto noisy = [&](double x) { return T(x + 0.003 * unit(rng)); };
      if (there[k])
        seen.push_back(in_world(
            base, DetectionFromBase<T>{{noisy(p_B.x), noisy(p_B.y), noisy(p_B.z)}, T(0.003), orange}));
    }
    CHECK_FALSE(tracks.see(m, m.time + 33ms, std::span<const ClassDetection<T>>(seen), everywhere).any());
  };
  for (int n = 0; n < 60; ++n) look();
  const auto before = m;

  real = stands_at(0.2, -0.8, 1.5);
  base.X_WB = stands_at(0.2 + 0.02 * unit(rng), -0.8 + 0.02 * unit(rng), 1.5 + 0.01 * unit(rng)).cast<T>();
  base.sigma = T(0.02), base.sigma_turn = T(0.01);
  Result out;
  if (told) CHECK_FALSE(tracks.drove(m, base).any());
  constexpr double sure = 0.006;  // of a hand whose fingers open 17 mm wider
  for (const auto& t : m.tracks) out.unsure += t.kind != 0 && double(t.sigma) > sure;
  const auto hand_at = [&](std::uint8_t k) {
    const auto X_BW = base.X_WB.inverse();
    const Xyz<T> aim = tracks.aim(m, m.tracks[k].p, base);
    return Xyz<double>(real.origin() +
                       real.axes() * skinctl::cast<double>(Xyz<T>(X_BW.origin() + X_BW.axes() * aim)));
  };
  constexpr double opens = 0.017;  // the fingers, beside a thing
  for (std::uint8_t k = 0; k < 32; ++k) {
    double nearest = 1;
    for (std::size_t i = 0; i < things; ++i)
      nearest = std::min(nearest, norm(Xyz<double>(place(i) - hand_at(k))));
    out.blind += m.tracks[k].kind != 0 && double(m.tracks[k].sigma) < sure && nearest > opens;
  }
  look();
  for (std::size_t k = 0; k < 32; ++k) out.same += before.tracks[k].kind != 0 && m.tracks[k].seen == m.time;
  for (const auto& t : m.tracks) out.tracks += t.kind != 0;
  // Takes: a hand that looks at what it is not sure of, in the base's axes as it believes them.
  for (int takes = 0; takes < 40; ++takes) {
    look();
    const std::uint8_t k = tracks.choose(
        m, [&](const auto& t) { return double(t.sigma) < sure; },
        [&](const auto& t) { return norm(Xyz<T>(t.p - base.X_WB.origin())); });
    if (k == no_object) break;
    const Xyz<double> hand = hand_at(k);
    bool has = false;
    for (std::size_t i = 0; i < things; ++i)
      if (there[i] && norm(Xyz<double>(place(i) - hand)) < opens) there[i] = false, has = true;
    if (has)
      tracks.took(m, k);
    else
      tracks.failed(m, k, true, everywhere), ++out.failed;
  }
  for (const bool left : there) out.lost += left;
  return out;
}

/// The track nearest to `x` along x, of those that are.
const Track<double>& near(const TracksFromBase<4>::Memory& m, double x) {
  const Track<double>* best = m.tracks.data();
  for (const auto& t : m.tracks)
    if (t.kind != 0 && (best->kind == 0 || std::abs(t.p.x - x) < std::abs(best->p.x - x))) best = &t;
  return *best;
}

}  // namespace

TEST_CASE_TEMPLATE("Tracks: after a drive with 20 mm of odometry things are looked at again, and found", T,
                   float, double) {
  Result told, untold;
  constexpr int runs = 200;
  for (int n = 0; n < runs; ++n)
    for (const bool tells : {true, false}) {
      const Result r = drive<T>(300 + static_cast<std::uint64_t>(n), tells);
      Result& sum = tells ? told : untold;
      sum.same += r.same, sum.failed += r.failed, sum.tracks += r.tracks, sum.unsure += r.unsure,
          sum.lost += r.lost, sum.blind += r.blind;
    }
  const auto share = [](int n) { return 100.0 * n / (runs * int(things)); };
  MESSAGE("told: ", share(told.same), " % the same track at once, ", share(told.tracks), " % tracks, ",
          share(told.failed), " % failed takes; not told: ", share(untold.same), " %, ", share(untold.tracks),
          " %, and without a look ", share(untold.blind), " % missed");
  CHECK(told.unsure >= runs * int(things));  // none is taken without a look
  CHECK(told.blind == 0);
  CHECK(share(untold.blind) > 40);
  CHECK(share(told.same) > 99.5);
  CHECK(share(told.tracks) < 100.5);
  CHECK(told.failed == 0);
  CHECK(told.lost == 0);
  CHECK(share(untold.same) < 90);
}

TEST_CASE("Tracks: a map that makes the base surer lets it leap, and things with it") {
  const TracksFromBase<4> tracks;
  TracksFromBase<4>::Memory m;
  BaseState<double> base;
  base.sigma = 0.03;
  const auto look = [&](double x) {
    CHECK_FALSE(tracks.drove(m, base).any());
    const ClassDetection<double> seen[] = {
        in_world(base, DetectionFromBase<double>{{x, 0, 0}, 0.003, orange})};
    CHECK_FALSE(tracks.see(m, m.time + 33ms, seen, everywhere).any());
  };
  for (int n = 0; n < 30; ++n) look(0.5);
  CHECK(near(m, 0.5).sigma < 0.003);  // a base that stands adds nothing from picture to picture
  base.X_WB = stands_at(0.05, 0, 0);
  base.sigma = 0.002;
  look(0.5);
  CHECK(std::count_if(m.tracks.begin(), m.tracks.end(), [](const auto& x) { return x.kind != 0; }) == 1);
  CHECK(near(m, 0.5).p.x == doctest::Approx(0.55).epsilon(0.01));
}

TEST_CASE("Tracks: a base that is none changes nothing; far things suffer more from a turn") {
  const TracksFromBase<4> tracks;
  TracksFromBase<4>::Memory m;
  const ClassDetection<double> seen[] = {{{0.5, 0, 0}, 0.003, orange}, {{3, 0, 0}, 0.003, orange}};
  CHECK_FALSE(tracks.see(m, 33ms, seen, everywhere).any());
  BaseState<double> base;
  base.sigma_turn = 0.01;
  const auto refuses = [&](Reason reason, auto&& spoil) {
    BaseState<double> bad = base;
    spoil(bad);
    const auto before = near(m, 0.5).sigma;
    CHECK(tracks.drove(m, bad) == Status(reason));
    CHECK(near(m, 0.5).sigma == before);
  };
  refuses(Reason::sample_not_finite, [](auto& b) { b.sigma = std::nan(""); });
  refuses(Reason::sample_not_finite, [](auto& b) { b.sigma_turn = HUGE_VAL; });
  refuses(Reason::sample_not_finite, [](auto& b) { b.X_WB = stands_at(std::nan(""), 0, 0); });
  refuses(Reason::sample_out_of_range, [](auto& b) { b.sigma = -0.01; });
  refuses(Reason::sample_out_of_range, [](auto& b) { b.sigma_turn = 11; });
  CHECK_FALSE(tracks.drove(m, base).any());
  CHECK(near(m, 0.5).sigma == doctest::Approx(std::hypot(0.003, 0.005)));
  CHECK(near(m, 3).sigma == doctest::Approx(std::hypot(0.003, 0.03)));
  CHECK_FALSE(tracks.drove(m, base).any());  // told again
  CHECK(near(m, 3).sigma == doctest::Approx(std::hypot(0.003, 0.03)));
  // A bias of the camera turns with the base.
  m.bias = {0.02, 0, 0};
  base.X_WB = stands_at(1, 0, M_PI / 2);
  const auto aim = tracks.aim(m, near(m, 0.5).p, base);
  CHECK(aim.x == doctest::Approx(near(m, 0.5).p.x));
  CHECK(aim.y == doctest::Approx(near(m, 0.5).p.y + 0.02));
}

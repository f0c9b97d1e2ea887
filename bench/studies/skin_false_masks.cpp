// Healthy cells that are masked: 260 cells of a UR5 at 250 Hz, with all that disturbs them and no fault.
//
//   skin_false_masks [seconds of the skin, 400] [first seed, 1] [-v: each mask]
//
// Touches (mean: one begins each second; 2 ms to 1 s to rise, 0.05 to 20 s long, of 0.7 to 3 pitches, half of
// them slide, 5 % at the end of the sensors' range, 2 % unseen by infrared light), grasps of two to five
// fingers, taps of 6 ms; drifts of single cells, of patches, creep; noise other than declared by up to 30 %;
// 1 % of the samples lost, 1 % of them up to 20 ms late.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

#include "bench/studies/worlds/skin_drifts.hpp"
#include "bench/studies/worlds/skin_fault_run.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr std::size_t cells = 260;

struct Disturbed {
  explicit Disturbed(std::uint64_t seed)
      : places(cell_places(ur5::skin_patches<cells>(fault_gains))),
        pitch(patch_pitches(places)),
        normal(seed),
        signals(places, {}, seed + 1) {
    for (double& x : extra) x = std::max(0.0, normal.between(-0.3, 0.3));
  }
  std::vector<CellPlace> places;
  std::vector<double> pitch;
  Normal normal;
  SkinSignals signals;
  std::array<double, cells> extra{};  ///< noise beyond what is declared, as a share of it
  struct Drift {
    std::size_t first, count;
    SkinDrift drift;
    double ends;
  };
  std::vector<Drift> drifts;
  struct Late {
    Nanoseconds at;
    CellSample sample;
  };
  std::vector<Late> late;
  double next_touch = 0.5, next_drift = 1;

  void touch(double at, std::size_t i, double size, double radius, double lasts, double rise, bool seen) {
    SkinTouch t{.link = places[i].link,
                .place = places[i].place,
                .radius = radius * pitch[places[i].patch],
                .reading = size,
                .from = nanoseconds(at),
                .until = nanoseconds(at + lasts),
                .rise = nanoseconds(rise),
                .tremor = normal.between(0.0, 0.2),
                .pulse = normal.between(30, 80),
                .seen = seen};
    if (normal.between(0.0, 1.0) < 0.5)
      for (double* v : {&t.velocity.x, &t.velocity.y, &t.velocity.z}) *v = normal.between(-0.1, 0.1);
    signals.touches.push_back(t);
  }
  void happens(double now) {
    const auto log_between = [&](double a, double b) {
      return a * std::pow(b / a, normal.between(0.0, 1.0));
    };
    const auto any = [&] { return normal.bits()() % cells; };
    std::erase_if(signals.touches, [&](const SkinTouch& t) { return seconds<double>(t.until) < now - 0.5; });
    std::erase_if(drifts, [&](const Drift& d) { return d.ends < now; });
    while (next_touch < now + 0.5) {
      const double at = next_touch, kind = normal.between(0.0, 1.0);
      next_touch += log_between(0.2, 5);
      const bool seen = normal.between(0.0, 1.0) >= 0.02;
      const double size = normal.between(0.0, 1.0) < 0.05 ? 1.1 : log_between(0.02, 0.6);
      if (kind < 0.15) {
        touch(at, any(), size, 1.1, 0.006, 0.002, seen);
      } else if (kind < 0.3) {
        const double lasts = log_between(0.5, 20), rise = log_between(0.02, 1);
        for (std::uint64_t fingers = 2 + normal.bits()() % 4; fingers > 0; --fingers)
          touch(at + normal.between(0.0, 0.1), any(), size * normal.between(0.3, 1.0),
                normal.between(0.7, 1.6), lasts, rise, seen);
      } else {
        touch(at, any(), size, normal.between(0.7, 3.0), log_between(0.05, 20), log_between(0.002, 1), seen);
      }
    }
    while (next_drift < now) {
      const auto kind = static_cast<SkinDrift::Kind>(normal.bits()() % 3);
      Seeded rng(static_cast<unsigned>(normal.bits()()));
      const SkinDrift d = random_drift(rng, kind, 80, next_drift);
      const std::size_t i = any();
      std::size_t first = i, count = 1;
      if (kind == SkinDrift::Kind::patch) {
        first = 0;
        while (places[first].patch != places[i].patch) ++first;
        while (first + count < cells && places[first + count].patch == places[i].patch) ++count;
      }
      drifts.push_back({first, count, d, next_drift + 60});
      next_drift += log_between(5, 60);
    }
  }
  void samples(Nanoseconds to, std::vector<CellSample>& out) {
    const double now = seconds<double>(to);
    happens(now);
    signals.samples(to, out);
    for (CellSample& s : out) {
      const std::size_t i = s.cell - 1;
      double off = extra[i] > 0 ? 0.7 * std::sqrt((1 + extra[i]) * (1 + extra[i]) - 1) : 0, all = 0;
      for (const Drift& d : drifts)
        if (i >= d.first && i < d.first + d.count) all += d.drift(seconds<double>(s.time)) / 3;
      if (off == 0 && all == 0) continue;
      for (float& f : s.force) {
        const double x = std::round(1024.0 * double(f) + all + (off > 0 ? off * normal() : 0.0)) / 1024;
        f = static_cast<float>(std::clamp(x, 0.0, 1.0));
      }
    }
    std::erase_if(out, [&](const CellSample& s) {
      const std::uint64_t bits = normal.bits()() % 1000;
      if (bits >= 20) return false;
      if (bits >= 10) late.push_back({s.time + nanoseconds(normal.between(0.001, 0.02)), s});
      return true;
    });
    std::erase_if(late, [&](const Late& l) {
      if (l.at > to) return false;
      out.push_back(l.sample);
      return true;
    });
  }
};

}  // namespace

int main(int argc, char** argv) {
  const double length = argc > 1 ? std::atof(argv[1]) : 400;
  const auto seed = static_cast<std::uint64_t>(argc > 2 ? std::atoi(argv[2]) : 1);
  const bool each = argc > 3 && std::strcmp(argv[3], "-v") == 0;
  const auto plain = ur5_skin<cells>(fault_gains);
  Disturbed skin(seed);
  const TrustedSkin trusted(plain, fault_trust(skin.signals.settings(), skin.places));
  auto m = std::make_unique<typename decltype(trusted)::Memory>(trusted.start(0ns));
  std::array<bool, cells> masked{};
  std::size_t masks = 0, of[cell_faults] = {};
  std::vector<CellSample> samples;
  typename decltype(plain)::Wrenches w;
  double touched = 0;
  for (Nanoseconds to = 8ms; seconds<double>(to) <= length; to += 8ms) {
    skin.samples(to, samples);
    trusted.receive(*m, samples, to - 8ms, to, 1, &w);
    touched += double(skin.signals.touches.size());
    for (std::size_t i = 0; i < cells; ++i) {
      const bool is = trusted.mask(*m, i) > 0.5f;
      if (is && !masked[i]) {
        ++masks;
        for (std::size_t f = 0; f < cell_faults; ++f) {
          if (!trusted.faults(*m, i).has(static_cast<CellFault>(f))) continue;
          ++of[f];
          if (!each) continue;
          std::printf("%.3f s: cell %zu %s;", seconds<double>(to), i + 1, name(static_cast<CellFault>(f)));
          for (const SkinTouch& t : skin.signals.touches)
            if (t.link == skin.places[i].link && t.from <= to) {
              const auto way = t.place - skin.places[i].place;
              std::printf(" touched %.3f to %.3f, %.2f, radius %.1f, %.1f pitches away, rise %.3f%s",
                          seconds<double>(t.from), seconds<double>(t.until), t.reading,
                          t.radius / skin.pitch[skin.places[i].patch],
                          std::sqrt(dot(way, way)) / skin.pitch[skin.places[i].patch],
                          seconds<double>(t.rise), t.seen ? "" : ", unseen");
            }
          std::printf("\n");
        }
      }
      masked[i] = is;
    }
  }
  std::printf("%.3g cell-seconds, %.1f touches at a time: %zu false masks", length * cells,
              touched / (length / 0.008), masks);
  for (std::size_t f = 0; f < cell_faults; ++f)
    if (of[f] > 0) std::printf(", %s %zu", name(static_cast<CellFault>(f)), of[f]);
  std::printf("\n");
  return 0;
}

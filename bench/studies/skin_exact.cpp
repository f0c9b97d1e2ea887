// Random updates of a skin and the difference of its sums to the exact ones: `skin_exact [updates]`, 1e9 if
// none are given. 8160 cells on six links; samples late, ahead, stale, swapped, damaged, of unknown cells;
// silences after which cells fade, end and are heard again. The exact sums are taken in 128-bit integers from
// what every cell holds; gains make one count 1 N, so that nothing is rounded on the way.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/skin_of.hpp"
#include "tests/support/random_skin.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

std::vector<SkinPatch> some_patches(Random& rng) {
  std::vector<SkinPatch> patches;
  std::uint32_t id = 1;
  for (std::size_t link = 0; link < 6; ++link) {
    SkinPatch& patch = patches.emplace_back(SkinPatch{link, {4096, 8192}, {}});
    for (int i = 0; i < 1360; ++i)
      patch.cells.push_back(
          {.id = id++,
           .X_LC = Transform<SomeLink, Cell>(random_rotation<double>(rng), random_xyz(rng, 0.3))});
  }
  return patches;
}

/// The largest difference between the sums of `skin` and the exact ones [N], [N m].
template <class S>
double difference(const S& skin, const typename S::Memory& memory, const std::vector<SkinPatch>& patches) {
  const auto touch = skin.touch(memory);
  double worst = 0;
  std::size_t i = 0;
  for (const SkinPatch& patch : patches) {
    double most = 0;
    for (const SkinCell& cell : patch.cells) {
      const auto m = unit_wrench(cell.X_LC).moment;
      most = std::max({most, std::abs(m.x), std::abs(m.y), std::abs(m.z)});
    }
    const int reach = static_cast<int>(std::ceil(std::log2(most)));
    __extension__ __int128 steps[2][6] = {};
    for (const SkinCell& cell : patch.cells) {
      const CellCounts held = skin.held(memory, i++);
      const auto u = unit_wrench(cell.X_LC);
      const double row[6] = {u.force.x, u.force.y, u.force.z, u.moment.x, u.moment.y, u.moment.z};
      for (std::size_t r = 0; r < 6; ++r) {
        const long unit = static_cast<long>(std::round(std::ldexp(row[r], 24 - (r < 3 ? 0 : reach))));
        steps[0][r] += unit * long{held.force};
        steps[1][r] += unit * long{held.proximity};
      }
    }
    for (std::size_t r = 0; r < 6; ++r) {
      const int exponent = (r < 3 ? 0 : reach) - 24;  // a count is 1/4 and 1/8 N
      worst = std::max(
          {worst, std::abs(touch.force.data[patch.link][r] - std::ldexp(double(steps[0][r]), exponent - 2)),
           std::abs(touch.proximity.data[patch.link][r] - std::ldexp(double(steps[1][r]), exponent - 3))});
    }
  }
  return worst;
}

}  // namespace

int main(int count, char** words) {
  const double updates = count > 1 ? std::strtod(words[1], nullptr) : 1e9;
  Random rng = seeded(1);
  const auto patches = some_patches(rng);
  using Large = SkinOf<ur5::Model, double, 8160>;
  const Large skin(patches);
  const auto memory = std::make_unique<Large::Memory>(skin.start(0ns));
  std::vector<CellSample> samples(4096);
  Nanoseconds now{};
  double done = 0, next = updates / 10, worst = 0;
  std::size_t ended = 0;
  Status seen;
  const auto start = std::chrono::steady_clock::now();
  for (std::uint64_t cycle = 0; done < updates; ++cycle) {
    const bool pause = cycle % 1000 == 999;  // long enough that cells fade, or end
    const Nanoseconds from = now;
    now += pause ? 190ms + Nanoseconds(rng() % 80000000u) : 2ms;
    for (CellSample& s : samples) {
      const std::uint64_t a = rng(), b = rng();
      s.cell = static_cast<std::uint32_t>(a % 8170);  // 0 and 8161 to 8169 are unknown
      s.time = now - Nanoseconds((a >> 16) % 2000000u);
      if ((a >> 40) % 64 == 0) s.time -= Nanoseconds(b % 400000000u);
      if ((a >> 46) % 64 == 0) s.time += 3ms;
      s.force = {float(b % 1025) / 1024, float((b >> 11) % 1025) / 1024, float((b >> 22) % 1028) / 1024};
      s.proximity = float((b >> 33) % 65537) / 65536;
      if ((a >> 52) % 8 == 0) s.force = {};
    }
    Large::Touch mean;
    seen |= skin.receive(*memory, samples, from, now, 1, &mean);
    if (pause) ended += skin.silent(*memory);
    done += double(samples.size());
    if (done >= next || done >= updates) {
      const bool same = skin.recomputed(*memory) == *memory;
      const double d = difference(skin, *memory, patches);
      worst = std::max(worst, same ? d : 1e300);
      std::printf("%.3g updates: largest difference to the exact sums %g, the same as from scratch: %s\n",
                  done, d, same ? "yes" : "NO");
      next += updates / 10;
    }
  }
  const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("cells that had fallen silent, summed over the pauses: %zu; statuses seen: %d of 5; %.0f s\n",
              ended,
              int(seen.has(Reason::time_backwards)) + int(seen.has(Reason::sample_stale)) +
                  int(seen.has(Reason::sample_out_of_range)) + int(seen.has(Reason::sample_unknown)) +
                  int(seen.any()),
              s);
  return worst == 0 ? 0 : 1;
}

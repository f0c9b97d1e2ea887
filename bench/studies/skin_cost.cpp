// What a cell costs, from 1260 cells to 100 000: `skin_cost [most cells [repetitions]]`. Median ns, all in one
// run, interleaved. An event is a sample that changes both readings, 6.5 % of the cells a cycle, stamps set
// beforehand; a scan reads and writes 44 bytes a cell, `[block][field][16]` floats, as trust in cells does.
// KDL: a Jacobian for each cell, and one for each link.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>

#include "bench/tactile/kdl_skin.hpp"
#include "skinctl/robots/ur5.hpp"
#include "skinctl/tactile/skin_of.hpp"
#include "tests/support/random_skin.hpp"
#include "tests/support/robots.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

template <class V>
void keep(V& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

/// Cells anywhere on the six links of a UR5, ids from 1 on.
std::vector<SkinPatch> some_cells(std::size_t count) {
  Random rng = seeded(count);
  std::vector<SkinPatch> patches;
  std::uint32_t id = 1;
  for (std::size_t link = 0; link < 6; ++link) {
    SkinPatch& patch = patches.emplace_back(SkinPatch{link, {10, 3}, {}});
    for (std::size_t i = count * link / 6; i < count * (link + 1) / 6; ++i)
      patch.cells.push_back(
          {.id = id++,
           .X_LC = Transform<SomeLink, Cell>(random_rotation<double>(rng), random_xyz(rng, 0.3))});
  }
  return patches;
}
/// The samples of some cycles of 2 ms; stamped anew for each pass.
struct Batches {
  std::size_t events, cycles;
  std::vector<CellSample> samples;
  Batches(std::size_t cells, bool changing)
      : events(cells * 65 / 1000),
        cycles(std::max<std::size_t>(1, 65000 / events)),
        samples(events * cycles) {
    Random rng = seeded(7);
    std::vector<std::uint32_t> ids(cells);
    for (std::size_t i = 0; i < cells; ++i) ids[i] = static_cast<std::uint32_t>(i + 1);
    for (std::size_t k = 0; k < samples.size(); ++k) {
      if (k % events == 0) std::shuffle(ids.begin(), ids.end(), rng);
      samples[k].cell = ids[k % events];
      for (float& f : samples[k].force) f = changing ? 0.1f + 0.9f * float(rng() % 1024) / 1024 : 0.01f;
      samples[k].proximity = changing ? 0.1f + 0.9f * float(rng() % 65536) / 65536 : 0.01f;
    }
  }
  void stamp(Nanoseconds start) {
    for (std::size_t k = 0; k < samples.size(); ++k)
      samples[k].time = start + (static_cast<std::int64_t>(k / events) + 1) * 2ms - 1ms;
  }
  std::span<const CellSample> cycle(std::size_t c) const {
    return std::span<const CellSample>(samples).subspan(c * events, events);
  }
};

struct Row {
  std::string name;
  double bytes;                  ///< that are moved a cell or event [B]
  std::function<double()> once;  ///< ns for one cell or event
  std::vector<double> found{};
};
template <class F>
double timed(double count, F&& f) {
  const auto a = std::chrono::steady_clock::now();
  f();
  const auto b = std::chrono::steady_clock::now();
  return std::chrono::duration<double, std::nano>(b - a).count() / count;
}

constexpr Nanoseconds hour = 3600s;
SkinSettings settings() {
  SkinSettings s;
  s.max_age = hour;
  return s;
}

/// Events through a skin.
template <class S, class Receive>
Row events(const std::string& name, std::shared_ptr<Batches> batches, S skin, std::size_t cells, double bytes,
           Receive receive) {
  auto now = std::make_shared<Nanoseconds>(0ns);
  std::vector<CellSample> all(cells);
  for (std::size_t i = 0; i < cells; ++i) all[i].cell = static_cast<std::uint32_t>(i + 1), all[i].time = 1ms;
  receive(*skin, all, 0ns, 100ms);
  *now = 100ms;
  return {name, bytes, [=] {
            batches->stamp(*now);
            return timed(double(batches->samples.size()), [&] {
              for (std::size_t c = 0; c < batches->cycles; ++c, *now += 2ms)
                receive(*skin, batches->cycle(c), *now, *now + 2ms);
            });
          }};
}

Row scan(std::size_t cells) {
  const std::size_t blocks = (cells + 15) / 16, times = std::max<std::size_t>(1, 300000 / cells);
  auto data = std::make_shared<std::vector<float>>(blocks * 11 * 16 + 16, 0.5f);
  return {"scan, 44 bytes read and written", 88, [=] {
            return timed(double(cells * times), [&] {
              for (std::size_t k = 0; k < times; ++k)
                for (std::size_t b = 0; b < blocks; ++b) {
                  float* x = data->data() + b * 11 * 16;
                  for (std::size_t i = 0; i < 16; ++i) {  // a filter, a rest level, six counters
                    const float r = x[i] - x[16 + i];
                    x[32 + i] += 0.02f * (x[i] - x[32 + i]);
                    x[16 + i] += (r < 0.1f ? 1e-4f : 0.0f) * r;
                    for (std::size_t f = 3; f < 11; ++f)
                      x[16 * f + i] = 0.99f * x[16 * f + i] + (r > x[16 * f + i] ? r : 0.0f);
                  }
                }
              keep(*data);
            });
          }};
}

/// A skin with its memory, which starts at 0.
template <std::size_t Cells>
struct SkinWithMemory {
  using Skin = SkinOf<ur5::Model, double, Cells>;
  explicit SkinWithMemory(const std::vector<SkinPatch>& patches)
      : skin(patches, settings()), memory(skin.start(0ns)) {}
  Skin skin;
  typename Skin::Memory memory;
};

template <std::size_t cells>
void print_rows(std::size_t most, int repetitions) {
  if (cells > most) return;
  const auto patches = some_cells(cells);
  auto busy = std::make_shared<Batches>(cells, true);
  auto calm = std::make_shared<Batches>(cells, false);
  std::vector<Row> rows;
  using Record = detail::CellRecord<Hexagon>;
  const double event_bytes = sizeof(CellSample) + 2 * sizeof(Record) + sizeof(detail::CellRow<Hexagon>) + 4;
  using S = SkinWithMemory<cells>;
  const auto receive = [](S& s, std::span<const CellSample> x, Nanoseconds from, Nanoseconds to) {
    typename S::Skin::Touch mean;
    s.skin.receive(s.memory, x, from, to, 1, &mean);
    keep(mean);
  };
  const auto skin = std::make_shared<S>(patches);
  const double memory = double(sizeof(skin->memory)) / double(cells);
  const double table = double(skin->skin.table_bytes()) / double(cells);
  rows.push_back(events("event, force and proximity apart", busy, skin, cells, event_bytes, receive));
  rows.push_back(
      events("sample that changes nothing", calm, std::make_shared<S>(patches), cells, event_bytes, receive));
  rows.push_back(scan(cells));
  if (cells <= 10000) {
    std::vector<bench::KdlCell> k;
    for (const SkinPatch& p : patches)
      for (const SkinCell& c : p.cells) {
        const auto u = unit_wrench(c.X_LC);
        const auto o = c.X_LC.origin();
        k.push_back({int(p.link),
                     {o.x, o.y, o.z},
                     {u.force.x, u.force.y, u.force.z, u.moment.x, u.moment.y, u.moment.z}});
      }
    auto kdl = std::make_shared<bench::KdlSkin>(oracle::ur5(), std::move(k));
    auto newton = std::make_shared<std::vector<double>>(cells, 1.0);
    const auto row = [=](auto member) {
      return [=] {
        const double q[6] = {0.3, -1.2, 1.4, -1.8, -1.57, 0.3};
        double tau[6];
        return timed(double(cells), [&] {
          ((*kdl).*member)(q, newton->data(), tau);
          keep(tau);
        });
      };
    };
    rows.push_back({"KDL, cell by cell", 0, row(&bench::KdlSkin::per_cell)});
    rows.push_back({"KDL, link by link", 0, row(&bench::KdlSkin::per_link)});
  }
  for (int r = 0; r < repetitions; ++r)
    for (Row& row : rows) row.found.push_back(row.once());
  std::printf("%zu cells; of each: memory %.1f bytes, tables %.1f\n", cells, memory, table);
  for (Row& row : rows) {
    std::sort(row.found.begin(), row.found.end());
    std::printf("  %-44s %8.2f ns  (least %.2f)  %5.0f bytes\n", row.name.c_str(),
                row.found[row.found.size() / 2], row.found[0], row.bytes);
  }
}

}  // namespace

int main(int count, char** words) {
  const std::size_t most = count > 1 ? std::strtoul(words[1], nullptr, 10) : 100000;
  const int repetitions = count > 2 ? std::atoi(words[2]) : 15;
  print_rows<1260>(most, repetitions);
  print_rows<10000>(most, repetitions);
  print_rows<100000>(most, repetitions);
}

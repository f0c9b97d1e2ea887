// The contacts of a skin: three usual ones, or every cell pressed.
#include <memory>

#include "bench/support/bench.hpp"
#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/tactile/contact_skin.hpp"

using namespace skinctl;

namespace {

enum class Pressed { none, usual, all };

/// One frame of a `ContactFinder`, its pushes given; `usual`: three contacts of about seven cells each.
template <std::size_t Cells>
void find(benchmark::State& state, Pressed pressed) {
  const auto places = cell_places(ur5::skin_patches<Cells>());
  const CellGraph graph(places);
  const ContactFinder<> finder(places, graph);
  std::vector<std::pair<std::size_t, double>> pushes;
  for (std::size_t i = 0; i < Cells; ++i) {
    bool on = pressed == Pressed::all;
    if (pressed == Pressed::usual)
      for (const std::size_t k : {Cells / 10, Cells / 3, Cells / 2}) on = on || i == k || graph.joined(k, i);
    if (on) pushes.push_back({i, 1 + double(i % 7)});
  }
  const auto memory = std::make_unique<SkinContactMemory<Cells, 16>>();
  PressedAreas<ur5::Model, all_links(6)> areas;
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    areas.clear();
    finder.find(
        *memory, 0ns,
        [&](auto&& f) SKINCTL_INLINE_LAMBDA {
          for (const auto& [i, push] : pushes) f(i, push);
        },
        areas);
    benchmark::DoNotOptimize(memory->list.data());
    benchmark::ClobberMemory();
  }
  state.counters["cells"] = double(pushes.size());
  state.counters["contacts"] = double(memory->count);
}

/// The way through the graph alone, all cells pressed: the floor of clusters.
template <std::size_t Cells>
void way(benchmark::State& state) {
  const CellGraph graph(cell_places(ur5::skin_patches<Cells>()));
  std::vector<ContactRow> rows(Cells);
  std::uint32_t frame = 0, clusters = 0;
  const bench::CountAllocations counted(state);
  for (auto _ : state) {
    frame += 2, clusters = 0;
    for (ContactRow& row : rows) row.frame_number = frame;
    for (std::uint32_t seed = 0; seed < Cells; ++seed) {
      if (rows[seed].frame_number != frame) continue;
      rows[seed].frame_number = frame + 1, rows[seed].next = ContactRow::none;
      for (std::uint32_t top = seed; top != ContactRow::none;) {
        const std::uint32_t i = top;
        top = rows[i].next;
        rows[i].label = clusters;
        for (const std::uint32_t j : graph.neighbours(i)) {
          if (rows[j].frame_number != frame) continue;
          rows[j].frame_number = frame + 1, rows[j].next = top;
          top = j;
        }
      }
      ++clusters;
    }
    benchmark::DoNotOptimize(rows.data());
    benchmark::ClobberMemory();
  }
  state.counters["contacts"] = clusters;
}

const int registered = [] {
  const auto add = [](const char* name, auto run, Pressed pressed) {
    benchmark::RegisterBenchmark(name, [=](benchmark::State& s) { run(s, pressed); });
  };
  add("tactile/contacts/none_1260/skinctl/double", find<1260>, Pressed::none);
  add("tactile/contacts/three_1260/skinctl/double", find<1260>, Pressed::usual);
  add("tactile/contacts/all_1260/skinctl/double", find<1260>, Pressed::all);
  add("tactile/contacts/three_10000/skinctl/double", find<10000>, Pressed::usual);
  add("tactile/contacts/all_10000/skinctl/double", find<10000>, Pressed::all);
  benchmark::RegisterBenchmark("tactile/contacts/all_1260/way_alone/double", way<1260>);
  return 0;
}();

}  // namespace

// The skin's network: how long it takes to organise itself, and to heal, beside a token that walks it depth
// first.
//
//   skin_network [rows = columns of the sheet, 100] [seeds, 8]
//
// A sheet of cells with the PC at a corner, 0.2 ms a hop. Each line: median and worst over the seeds.
// "labelled": from the PC's first message until the last label is given. "reported": until the PC has the
// names of all neighbours, without loss, first seed only. "healed": from the fault until all labels are given
// again and the tree is what an all-seeing search says.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "bench/studies/worlds/skin_network_oracle.hpp"

using namespace skinctl;
using namespace skinctl::testing;
using namespace std::chrono_literals;

namespace {

struct Column {
  std::vector<double> values;
  void print(const char* format) {
    if (values.empty()) values.push_back(0);
    std::sort(values.begin(), values.end());
    std::printf(format, values[values.size() / 2]);
    std::printf(format, values.back());
  }
};

const auto never = [] { return false; };

// All labels of the present epoch are with their cells.
bool all_labelled(const SkinNetwork& net, const std::vector<unsigned>& d) {
  if (!net.labelled() || net.root().due()) return false;
  for (std::size_t n = 1; n < d.size(); ++n)
    if (d[n] != 0 && (net.cell(n).epoch != net.root().epoch() || net.cell(n).label == 0)) return false;
  return true;
}

struct Case {
  const char* name;
  double loss = 0, flipped = 0, cut = 0, corrupt = 0;
};

}  // namespace

int main(int argc, char** argv) {
  const std::size_t side = argc > 1 ? std::size_t(std::atoi(argv[1])) : 100;
  const int seeds = argc > 2 ? std::atoi(argv[2]) : 8;
  std::printf("%zu cells, %d seeds: median and worst\n", side * side, seeds);
  std::printf("%-34s %17s %17s %17s %17s %13s\n", "", "labelled [s]", "healed [s]", "reported [s]",
              "token [s]", "messages/cell");
  const Case cases[] = {{"no loss"},
                        {"10 % of the frames lost", 0.1},
                        {"30 % of the frames lost", 0.3},
                        {"5 % lost, 5 % with flipped bits", 0.05, 0.05},
                        {"10 % of the links cut", 0, 0, 0.1},
                        {"a third of the memories corrupt", 0, 0, 0, 0.32}};
  int wrong = 0;
  for (const Case& c : cases) {
    Column labelled, healed, reported, token, messages;
    for (int seed = 1; seed <= seeds; ++seed) {
      auto rng = seeded(std::uint64_t(seed));
      SkinNetwork net(SkinTopology::sheet(side, side), {.loss = c.loss, .flipped = c.flipped},
                      std::uint64_t(seed));
      // Switched on: the links find each other; then the PC comes.
      net.cut(0, 0);
      net.run(100ms, never);
      net.join(0, 0, 1, 2);
      auto d = distances(net.topology());
      net.run(5s, [&] { return net.root().state() == NetworkRoot::State::exploring; });
      net.forget_messages();
      auto from = net.now();
      std::size_t look = 0;
      const auto done = [&] { return ++look % 64 == 0 && net.labelled() && all_labelled(net, d); };
      if (!net.run(net.now() + 20s, done)) ++wrong;
      labelled.values.push_back(seconds<double>(net.now() - from));
      // The reports of 10 000 cells at one port take seconds: once is enough.
      const bool all = seed == 1 && c.loss + c.cut + c.corrupt == 0;
      if (all) {
        if (!net.run_until_organised(net.now() + 60s)) ++wrong;
        reported.values.push_back(seconds<double>(net.now() - from));
      }
      using Kind = CellMessage::Kind;
      messages.values.push_back(double(net.messages(Kind::explore) + net.messages(Kind::echo) +
                                       net.messages(Kind::assign) + net.messages(Kind::name)) /
                                double(side * side));
      if (const auto error = network_error(net, all); !error.empty())
        ++wrong, std::printf("%s\n", error.c_str());
      token.values.push_back(token_seconds(net.topology(), c.loss + c.flipped, 2e-4, rng));
      healed.values.push_back(0);
      if (c.cut + c.corrupt == 0) continue;

      from = net.now();
      for (std::size_t n = 1; n < d.size(); ++n) {
        for (std::size_t p = 0; p < 4; ++p) {
          const auto& e = net.topology().ports[n][p];
          if (e.joined && e.node > n && double(rng() >> 11) * 0x1p-53 < c.cut) net.cut(n, p);
        }
        if (double(rng() >> 11) * 0x1p-53 < c.corrupt) {
          CellMemory m;
          std::array<std::uint8_t, sizeof m> bytes;
          for (auto& b : bytes) b = std::uint8_t(rng());
          std::memcpy(static_cast<void*>(&m), bytes.data(), sizeof m);
          net.corrupt(n, m, false);
        }
      }
      d = distances(net.topology());
      const auto old = net.root().epoch();
      look = 0;
      if (!net.run(net.now() + 20s, [&] { return net.root().epoch() > old && done(); })) ++wrong;
      healed.values.back() = seconds<double>(net.now() - from);
      if (all && !net.run_until_organised(net.now() + 60s)) ++wrong;
      if (const auto error = network_error(net, all); !error.empty())
        ++wrong, std::printf("%s\n", error.c_str());
    }
    std::printf("%-34s", c.name);
    labelled.print(" %8.3f"), healed.print(" %8.3f"), reported.print(" %8.3f"), token.print(" %8.3f");
    messages.print(" %6.2f");
    std::printf("\n");
    std::fflush(stdout);
  }
  std::printf("%d wrong or unfinished\n", wrong);
  return wrong == 0 ? 0 : 1;
}

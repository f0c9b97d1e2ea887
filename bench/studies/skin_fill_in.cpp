// Filling in masked cells: error of the skin's torque on a UR5 with 383 cells, under one contact anywhere on
// its upper arm or forearm but for the rims of the patches, with 10 and 30 % of all cells masked at random.
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "skinctl/robots/ur5_skin.hpp"
#include "skinctl/tactile/cell_graph.hpp"
#include "skinctl/tactile/fill_in.hpp"
#include "skinctl/tactile/skin_torque.hpp"
#include "skinctl/testing/pressing.hpp"
#include "skinctl/testing/random.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr std::size_t count = 383;
constexpr int contacts = 20'000;
constexpr double pitch = 0.0278;
constexpr LinkMask skinned = all_links(6);
using Wrenches = LinkWrenches<ur5::Model, skinned, double>;

/// The torque of pushes along the cells' normals.
JointTorque<6> torque(const JointPosition<6>& q, const std::vector<CellPlace>& cells,
                      const std::vector<double>& push) {
  std::array<Xyz<double>, 6> force{}, moment{};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (push[i] == 0) continue;
    const Xyz<double> f = -push[i] * cells[i].normal;
    force[cells[i].link] = force[cells[i].link] + f;
    moment[cells[i].link] = moment[cells[i].link] + cross(cells[i].place, f);
  }
  Wrenches w;
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (w.template set<I>({force[I], moment[I]}), ...);
  }(std::make_index_sequence<6>{});
  return skin_torque(ur5::Model{}, q, w);
}
double size(const JointTorque<6>& tau) {
  double sum = 0;
  for (const double t : tau) sum += t * t;
  return std::sqrt(sum);
}
/// A body at most half a pitch off the middle of a cell of link 1 or 2 that has six neighbours.
Pressing anywhere(Random& rng, const std::vector<CellPlace>& cells, const CellGraph& graph, double radius) {
  std::size_t i = 0;
  do i = static_cast<std::size_t>(uniform(rng, 0.0, double(count)));
  while (i >= count || (cells[i].link != 1 && cells[i].link != 2) || graph.neighbours(i).size() < 6);
  const Xyz<double> n = cells[i].normal;
  Xyz<double> way{uniform(rng, -0.5, 0.5), uniform(rng, -0.5, 0.5), uniform(rng, -0.5, 0.5)};
  way = pitch * (way - dot(way, n) * n);
  return {cells[i].link, cells[i].place + way, n, radius, 10};
}

}  // namespace

int main() {
  const auto cells = cell_places(ur5::skin_patches<count>());
  const CellGraph graph(cells);
  Random rng = seeded(20261123);
  const FillIn mean(graph), field(graph, cells);
  std::printf("error of the torque [%% of the healthy skin's, mean of %d contacts]\n", contacts);
  std::printf("radius [pitches]   masked   left out   mean of neighbours   two rings\n");
  for (const double radius : {0.7, 1.1, 1.6, 2.0, 2.5})
    for (const double share : {0.1, 0.3}) {
      double error[3] = {};
      int felt = 0;
      while (felt < contacts) {
        const Pressing body = anywhere(rng, cells, graph, pitch * radius);
        const std::vector<double> push = pushes(cells, std::span(&body, 1));
        double pushed = 0;
        for (const double p : push) pushed += p;
        if (!(pushed > 0)) continue;  // between the cells
        ++felt;
        std::vector<bool> masked(count);
        for (std::size_t i = 0; i < count; ++i) masked[i] = uniform(rng, 0.0, 1.0) < share;
        JointPosition<6> q;
        for (double& x : q) x = uniform(rng, -3.0, 3.0);

        std::array<std::vector<double>, 3> less{push, push, push};
        const auto reading = [&](std::size_t j) { return push[j]; };
        const auto counts = [&](std::size_t j) { return !masked[j]; };
        for (std::size_t i = 0; i < count; ++i)
          if (masked[i]) {
            less[0][i] = push[i], less[1][i] = push[i] - mean.filled(i, reading, counts);
            less[2][i] = push[i] - field.filled(i, reading, counts);
          } else {
            less[0][i] = less[1][i] = less[2][i] = 0;
          }
        const double whole = size(torque(q, cells, push));
        for (std::size_t m = 0; m < 3; ++m) error[m] += size(torque(q, cells, less[m])) / whole;
      }
      std::printf("%16.1f   %4.0f %%   %6.1f %%   %16.1f %%   %7.1f %%\n", radius, 100 * share,
                  100 * error[0] / contacts, 100 * error[1] / contacts, 100 * error[2] / contacts);
    }
  return 0;
}

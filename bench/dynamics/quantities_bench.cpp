// What scenes pay for what they ask of the model: everything computed once, nothing else.
#include "bench/support/rows.hpp"
#include "skinctl/dynamics/quantities.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;

namespace {

template <Needs Asked, class T>
void scene_row(const char* scene) {
  bench::row<6, T>(std::string("dynamics/quantities/ur5-") + scene + "/skinctl/" + bench::scalar_name<T>,
                   [](const auto& s) {
                     const ur5::Model model;
                     const NoTouch touch;
                     const State<6, T> state{0ns, s.q, s.dq};
                     const Quantities<ur5::Model, Asked, T> known(model, state, T(0.002), touch);
                     benchmark::DoNotOptimize(&known);
                     return 0;
                   });
}

template <class T>
void rows() {
  scene_row<Needs{.poses = 0b000111}, T>("links-1-to-3");
  scene_row<Needs{.gravity = true}, T>("gravity");
  scene_row<Needs{.poses = 0b000111, .gravity = true}, T>("gravity-and-links-1-to-3");
  scene_row<Needs{.poses = 0b111111}, T>("all-links");
  scene_row<
      Needs{.poses = 0b111111, .jacobians = link_bit<5>, .gravity = true, .mass = true, .coriolis = true}, T>(
      "everything");
}

const bool registered = (rows<double>(), rows<float>(), true);

}  // namespace

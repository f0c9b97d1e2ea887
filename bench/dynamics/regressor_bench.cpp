// The regressor and its products, and energies, beside inverse dynamics with fixed parameters.
#include "bench/support/rows.hpp"
#include "skinctl/dynamics/energy.hpp"
#include "skinctl/dynamics/regressor.hpp"
#include "skinctl/model/ur5.hpp"

using namespace skinctl;

namespace {

template <class T>
void rows() {
  const std::string end = std::string("/ur5/skinctl/") + bench::scalar_name<T>;
  const ur5::Model model;
  const auto theta = inertial_parameters<T>(model);
  bench::row<6, T>("dynamics/yr-theta-fixed" + end,
                   [model](const auto& s) { return yr_theta(model, s.q, s.dq, s.dq_r, s.ddq); });
  bench::row<6, T>("dynamics/regressor-product" + end, [model, theta](const auto& s) {
    return regressor_product(model, s.q, s.dq, s.dq_r, s.ddq, theta);
  });
  bench::row<6, T>("dynamics/regressor-transposed-product" + end, [model](const auto& s) {
    return regressor_transposed_product(model, s.q, s.dq, s.dq_r, s.ddq, s.dq);
  });
  bench::row<6, T>("dynamics/regressor" + end,
                   [model](const auto& s) { return regressor(model, s.q, s.dq, s.dq_r, s.ddq); });
  bench::row<6, T>("dynamics/kinetic-energy" + end,
                   [model](const auto& s) { return kinetic_energy(model, s.q, s.dq); });
  bench::row<6, T>("dynamics/generalised-momentum" + end,
                   [model](const auto& s) { return generalised_momentum(model, s.q, s.dq); });
}

const bool registered = (rows<double>(), rows<float>(), true);

}  // namespace

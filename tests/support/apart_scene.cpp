#include "tests/support/apart_scene.hpp"

#include "skinctl/cycle/apart_definitions.hpp"

template class skinctl::Apart<skinctl::testing::ReachingScene>;
template class skinctl::Apart<skinctl::testing::TwoGains>;

namespace skinctl::testing {

Apart<ReachingScene> reaching_scene_apart() {
  return Apart(reaching_scene());
}
TwoGains two_gains() {
  return Configurations(kinesthetic_scene<Interface::position, 6>(),
                        kinesthetic_scene<Interface::position, 6>({.force_gain = 60}));
}
Apart<TwoGains> two_gains_apart() {
  return Apart(two_gains());
}

}  // namespace skinctl::testing

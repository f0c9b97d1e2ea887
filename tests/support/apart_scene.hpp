// Two scenes whose code stands in apart_scene.cpp.
#pragma once

#include "skinctl/cycle/apart.hpp"
#include "skinctl/cycle/configurations.hpp"
#include "tests/support/scene.hpp"

namespace skinctl::testing {

using ReachingScene = decltype(reaching_scene());
/// Two gains of the skin: a scene whose start takes no `told`.
using TwoGains = decltype(Configurations(kinesthetic_scene<Interface::position, 6>(),
                                         kinesthetic_scene<Interface::position, 6>()));

Apart<ReachingScene> reaching_scene_apart();
TwoGains two_gains();
Apart<TwoGains> two_gains_apart();

}  // namespace skinctl::testing

extern template class skinctl::Apart<skinctl::testing::ReachingScene>;
extern template class skinctl::Apart<skinctl::testing::TwoGains>;

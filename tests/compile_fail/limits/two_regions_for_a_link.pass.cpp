#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto right(const LinkContact<2>& arm, const LinkContact<4>& hand) {
  return contact_limits(ur5::Model{}, arm, hand);
}

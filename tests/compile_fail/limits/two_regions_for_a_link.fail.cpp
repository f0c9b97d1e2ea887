// expect: two contact limits for one link
#include "skinctl/skinctl.hpp"

using namespace skinctl;

auto wrong(const LinkContact<2>& arm, const LinkContact<2>& hand) {
  return contact_limits(ur5::Model{}, arm, hand);
}

// expect: two contact limits for one link
#include "skinctl/skinctl.hpp"

using namespace skinctl;

#ifdef SKINCTL_RIGHT
auto right(const LinkContact<2>& arm, const LinkContact<4>& hand) {
#else
auto wrong(const LinkContact<2>& arm, const LinkContact<2>& hand) {
#endif
  return contact_limits(ur5::Model{}, arm, hand);
}

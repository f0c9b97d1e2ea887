// expect: unit length
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Taxel {
  static constexpr std::string_view name = "taxel-1";
  static constexpr std::array readings{Reading{"x", -20, 20}, Reading{"z", 0, 20}};
  static constexpr std::array channels{
      Channel{"normal", ChannelUse::contact, 0b10, 20},
#ifdef SKINCTL_RIGHT
      Channel{"shear x", ChannelUse::contact, 0b01, 20, {1, 0, 0}, {}, with_normal}};
#else
      Channel{"shear x", ChannelUse::contact, 0b01, 20, {1, 1, 0}, {}, with_normal}};
#endif
};

const Patch<2, 1, Taxel> patch({{7, Transform<Link<2>, Cell>::translation_xyz(0, 0, 0)}});

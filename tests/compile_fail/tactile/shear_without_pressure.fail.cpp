// expect: beside a pressure
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Taxel {
  static constexpr std::string_view name = "taxel-1";
  static constexpr std::array readings{Reading{"x", -20, 20}, Reading{"z", 0, 20}};
  static constexpr std::array channels{
#ifdef SKINCTL_RIGHT
      Channel{"normal", ChannelUse::contact, 0b10, 20},
#endif
      Channel{"shear x", ChannelUse::contact, 0b01, 20, {1, 0, 0}, {}, with_normal}};
};

const Patch<2, 1, Taxel> patch({{7, Transform<Link<2>, Cell>::translation_xyz(0, 0, 0)}});

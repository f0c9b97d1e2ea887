// expect: make a skin of each, and add them
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Taxel {
  static constexpr std::string_view name = "taxel-1";
  static constexpr std::array readings{Reading{"x", -20, 20}, Reading{"z", 0, 20}};
  static constexpr std::array channels{
      Channel{"normal", ChannelUse::contact, 0b10, 20},
      Channel{"shear x", ChannelUse::contact, 0b01, 20, {1, 0, 0}, {}, with_normal}};
};

const auto at = Transform<Link<2>, Cell>::translation_xyz(0, 0, 0);
const Patch<2, 1, Taxel> taxels({{7, at}});
const Patch<2, 1> hexagons({{8, at}});
#ifdef SKINCTL_RIGHT
const auto touch =
    Skin<ur5::Model, double, Patch<2, 1, Taxel>>(taxels) + Skin<ur5::Model, double, Patch<2, 1>>(hexagons);
#else
const Skin<ur5::Model, double, Patch<2, 1, Taxel>, Patch<2, 1>> skin(taxels, hexagons);
#endif

// expect: told stand behind
#include "skinctl/skinctl.hpp"

using namespace skinctl;

struct Taxel {
  static constexpr std::string_view name = "taxel-1";
  static constexpr std::array readings{Reading{"x", -20, 20}, Reading{"z", 0, 20}};
#ifdef SKINCTL_RIGHT
  static constexpr std::array channels{Channel{"normal", ChannelUse::contact, 0b10, 20},
                                       Channel{"x", ChannelUse::told, 0b01}};
#else
  static constexpr std::array channels{Channel{"x", ChannelUse::told, 0b01},
                                       Channel{"normal", ChannelUse::contact, 0b10, 20}};
#endif
};

const Patch<2, 1, Taxel> patch({{7, Transform<Link<2>, Cell>::translation_xyz(0, 0, 0)}});

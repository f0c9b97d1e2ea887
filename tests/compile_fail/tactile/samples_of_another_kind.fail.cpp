// expect: SensorSample<[a-z_:]*Taxel>
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
using S = Skin<ur5::Model, double, Patch<2, 1, Taxel>>;

Status take(const S& skin, S::Memory& memory, KindInput<Taxel>& input,
#ifdef SKINCTL_RIGHT
            const std::vector<SensorSample<Taxel>>& samples) {
#else
            const std::vector<CellSample>& samples) {
#endif
  input.taxels = samples;
  S::Wrenches mean;
  return skin.receive(memory, input.taxels, 0ns, 1ms, 1, &mean);
}

#include "examples/calibrate_skin/wire.hpp"

#include <stdexcept>

#include "examples/support/text.hpp"

namespace calibrate_skin {

using namespace skinctl;
using examples::text;

namespace {

constexpr double gravity = 9.80665;  // [m/s^2]

adapters::skin::ReceiverConfig configured(const WireOptions& o) {
  adapters::skin::ReceiverConfig config;
  config.address = o.address, config.port = o.port;
  config.real_time = false;  // a simulated robot may be faster
  if (!o.key.empty()) config.key = adapters::skin::Key::read(o.key);
  return config;
}

}  // namespace

WireSkin::WireSkin(const WireOptions& options) : receiver_(configured(options)) {}

ArmOptions WireSkin::listening(ArmOptions arm) {
  arm.each_cycle = [this](Nanoseconds now) {
    for (const CellSample& s : receiver_.poll(now)) {
      const Eigen::Vector3d a(double(s.acceleration[0]), double(s.acceleration[1]),
                              double(s.acceleration[2]));
      kept_[s.cell].push_back({s.time, a / gravity});
    }
  };
  return arm;
}

std::string WireSkin::said() const {
  const auto& s = receiver_.statistics();
  const std::string refused = adapters::skin::refusals(s), leaps = receiver_.leaps();
  return text("%llu datagrams of the skin, %llu lost", static_cast<unsigned long long>(s.datagrams),
              static_cast<unsigned long long>(s.lost)) +
         (leaps.empty() ? "" : "; " + leaps) + (refused.empty() ? "" : "; " + refused);
}

const std::vector<WireSkin::Reading>& WireSkin::of(std::uint16_t id, std::size_t least) const {
  const auto found = kept_.find(id);
  const std::size_t n = found == kept_.end() ? 0 : found->second.size();
  if (n < least)
    throw std::runtime_error(text("cell %d sent %zu accelerations of the %zu that are needed; port %d heard ",
                                  int(id), n, least, int(receiver_.port())) +
                             said());
  return found->second;
}

Eigen::Vector3d WireSkin::mean(std::uint16_t id, std::size_t least) const {
  const auto& all = of(id, least);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Reading& r : all) sum += r.g;
  return sum / double(all.size());
}

CellReadings WireSkin::readings(std::uint16_t id, Nanoseconds from, double duration,
                                std::size_t least) const {
  constexpr double edge = 0.3;  // the spline through the encoders ends there [s]
  const auto& all = of(id, least);
  CellReadings out;
  out.y.resize(3, Eigen::Index(all.size()));
  for (const Reading& r : all) {
    const double t = seconds<double>(r.time - from);
    if (t < edge || t > duration - edge) continue;
    out.y.col(Eigen::Index(out.time.size())) = r.g;
    out.time.push_back(t);
  }
  out.y.conservativeResize(3, Eigen::Index(out.time.size()));
  return out;
}

}  // namespace calibrate_skin

#include "examples/simulated_arm/rsi.hpp"

#include <numbers>

namespace simulated_arm {
namespace {

constexpr double degree = std::numbers::pi / 180;
using adapters::rsi::Correction;

class RsiFace final : public Face {
 public:
  RsiFace(const Config& config, const RsiConfig& rsi) : config_(config), rsi_(rsi) {}
  [[nodiscard]] double period() const override { return rsi_.period; }

  std::size_t hear(std::span<const std::uint8_t> bytes, Arm&, std::span<std::uint8_t>) override {
    adapters::rsi::Sen sen;
    const std::string_view xml(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (!parse(xml, sen) || sen.ipoc != ipoc_ || answered_) return 0;
    answered_ = begun_ = true;
    sen_ = sen;
    ++answers;
    return 0;
  }

  void cycle(Arm& arm) override {
    if (begun_ && ended.empty()) {
      if (!answered_) {
        ++late;
        if (!rsi_.hold_on) sen_.correction = {};
        if (++unanswered_ > rsi_.timeout) return end(arm, "Timeout: answers are missing");
      } else {
        unanswered_ = 0;
      }
      apply(arm);
    }
    if (sen_.stop) end(arm, "Stop was asked for");
    answered_ = false;
    ipoc_ += rsi_.ipoc_per_cycle;
  }

  std::size_t state(const Arm& arm, std::span<std::uint8_t> out) override {
    if (!ended.empty()) return 0;
    adapters::rsi::Rob rob{.ipoc = ipoc_, .late = static_cast<std::uint32_t>(late)};
    rob.has_setpoint = rob.has_late = true;
    rob.has_wrench = config_.sensor;
    rob.wrench = arm.wrench();
    for (std::size_t i = 0; i < 6; ++i) {
      rob.actual[i] = arm.q()[i] / degree;
      rob.setpoint[i] = arm.told()[i] / degree;
    }
    const auto size = print(rob, {reinterpret_cast<char*>(out.data()), out.size()});
    if (!config_.faults.fewer_joints) return size;
    std::string text(reinterpret_cast<const char*>(out.data()), size);
    for (auto at = text.find(" A6="); at != text.npos; at = text.find(" A6="))
      text.erase(at, text.find('/', at) - at);
    std::copy(text.begin(), text.end(), out.begin());
    return text.size();
  }

  [[nodiscard]] bool answered() const override { return answered_ || !begun_ || !ended.empty(); }
  void emergency_stop(Arm& arm) override { end(arm, "emergency stop"); }
  void restart() override { ipoc_ = 1000; }

 private:
  void apply(Arm& arm) {
    SixJoints q{};
    for (std::size_t i = 0; i < 6; ++i) {
      double& sum = correction_[i];
      const double before = sum;
      sum = rsi_.correction == Correction::relative ? sum + sen_.correction[i] : sen_.correction[i];
      if (std::abs(sum) > rsi_.axis_corr_mon)
        return end(arm, "AXISCORRMON: correction of A" + std::to_string(i + 1));
      sum = std::clamp(sum, -rsi_.axis_corr, rsi_.axis_corr);
      if (std::abs(sum - before) > rsi_.max_axis_speed * rsi_.period)
        return end(arm, "speed of A" + std::to_string(i + 1));
      q[i] = config_.home[i] + degree * sum;
    }
    arm.command(q);
  }

  Config config_;
  RsiConfig rsi_;
  adapters::rsi::Sen sen_;
  std::array<double, 6> correction_{};
  std::uint64_t ipoc_ = 4'000'000;
  unsigned unanswered_ = 0;
  bool answered_ = false, begun_ = false;
};

}  // namespace

std::unique_ptr<Face> rsi_face(const Config& config, const RsiConfig& rsi) {
  return std::make_unique<RsiFace>(config, rsi);
}
std::unique_ptr<Controller> rsi_controller(const Config& config, const RsiConfig& rsi,
                                           const std::string& host, std::uint16_t port) {
  return std::make_unique<Controller>(rsi_face(config, rsi), adapters::UdpSocket::to(host, port), config);
}

}  // namespace simulated_arm

#include "examples/simulated_arm/egm.hpp"

#include <numbers>

namespace simulated_arm {
namespace {

constexpr double degree = std::numbers::pi / 180;
using namespace adapters::egm;

class EgmFace final : public Face {
 public:
  EgmFace(const Config& config, const EgmConfig& egm) : config_(config), egm_(egm) {
    for (std::size_t i = 0; i < 6; ++i) asked_[i] = setpoint_[i] = config.home[i];
  }
  [[nodiscard]] double period() const override { return egm_.period; }

  std::size_t hear(std::span<const std::uint8_t> bytes, Arm&, std::span<std::uint8_t>) override {
    SensorMessage m;
    if (!parse(bytes, m) || m.joints != 6 || !follows()) return 0;
    for (std::size_t i = 0; i < 6; ++i) asked_[i] = degree * m.planned[i];
    answered_ = begun_ = true;
    silent_ = 0;
    ++answers;
    return 0;
  }

  void cycle(Arm& arm) override {
    if (begun_ && ended.empty()) {
      if (!answered_) {
        ++late;
        silent_ += egm_.period;
        if (silent_ > egm_.comm_timeout) end(arm, "CommTimeout");
      }
      const double most = degree * egm_.max_speed * egm_.period;
      for (std::size_t i = 0; i < 6; ++i) setpoint_[i] += std::clamp(asked_[i] - setpoint_[i], -most, most);
      if (ended.empty()) arm.command(setpoint_);
    }
    answered_ = false;
    ++number_, ++cycles_;
  }

  std::size_t state(const Arm& arm, std::span<std::uint8_t> out) override {
    RobotMessage m{.number = number_, .time = static_cast<std::uint32_t>(1e3 * arm.time()), .joints = 6};
    if (config_.faults.fewer_joints) m.joints = 4;
    m.has_planned = true;
    for (std::size_t i = 0; i < 6; ++i) {
      m.feedback[i] = arm.q()[i] / degree;
      m.planned[i] = arm.told()[i] / degree;
    }
    m.motors = emergency_ ? Motors::off : Motors::on;
    m.guided = follows() ? Guided::running : Guided::stopped;
    m.rapid = emergency_ ? Rapid::stopped : Rapid::running;
    m.has_force = config_.sensor;
    m.force = arm.wrench();
    return print(m, out);
  }

  [[nodiscard]] bool answered() const override { return answered_ || !begun_ || !ended.empty(); }
  void emergency_stop(Arm& arm) override { emergency_ = true, end(arm, "emergency stop"); }
  void restart() override { number_ = 0; }

 private:
  [[nodiscard]] bool follows() const { return cycles_ >= egm_.before && ended.empty(); }

  Config config_;
  EgmConfig egm_;
  SixJoints asked_{}, setpoint_{};  ///< [rad]
  double silent_ = 0;               ///< time without an answer [s]
  std::uint32_t number_ = 0;
  unsigned cycles_ = 0;
  bool answered_ = false, begun_ = false, emergency_ = false;
};

}  // namespace

std::unique_ptr<Face> egm_face(const Config& config, const EgmConfig& egm) {
  return std::make_unique<EgmFace>(config, egm);
}
std::unique_ptr<Controller> egm_controller(const Config& config, const EgmConfig& egm,
                                           const std::string& host, std::uint16_t port) {
  return std::make_unique<Controller>(egm_face(config, egm), adapters::UdpSocket::to(host, port), config);
}

}  // namespace simulated_arm

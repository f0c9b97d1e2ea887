#include "examples/simulated_arm/fri.hpp"

namespace simulated_arm {
namespace {

using namespace adapters::fri;

class FriFace final : public SpringFace {
 public:
  FriFace(const Config& config, const FriConfig& fri) : config_(config), fri_(fri), held_(fri.arm.home) {}
  [[nodiscard]] double period() const override { return 1e-3 * fri_.send_period; }

  std::size_t hear(std::span<const std::uint8_t> bytes, SpringArm&, std::span<std::uint8_t>) override {
    Command c;
    if (!parse(bytes, c) || c.axes != SpringArm::joints) return 0;
    // One answer counts for the messages from one judgement to the next: to which of them is the client's
    // choice.
    if (answered_ || number_ - c.header.reflected >= fri_.multiplier) return 0;
    command_ = c;
    answered_ = begun_ = true;
    ++answers;
    return 0;
  }

  void cycle(SpringArm& arm) override {
    const bool judged = (number_ + 1) % fri_.multiplier == 0;
    if (judged && begun_) judge_answer();
    const double t = arm.time();
    const bool poor = fri_.poor_at >= 0 && t >= fri_.poor_at;
    quality_ = poor || !begun_ ? Quality::poor : quality_of(missing());
    if (session_ == Session::commanding) {
      if (quality_ < Quality::good) fall_back(arm, "quality below GOOD");
      if (fri_.motion_ends_at >= 0 && t >= fri_.motion_ends_at)
        fall_back(arm, "the Java program's motion has ended");
    }
    if (ended.empty() && judged) go_on(arm);
    if (judged) answered_ = false;
    ++number_;
  }

  std::size_t state(const SpringArm& arm, std::span<std::uint8_t> out) override {
    Monitoring m;
    m.header.number = number_;
    m.header.reflected = command_.header.number;
    m.axes = config_.faults.fewer_joints ? 6 : SpringArm::joints;
    m.safety = emergency_ ? 3 : 0;
    m.control = fri_.control;
    m.measured = arm.q();
    m.measured_torque = SevenJoints{};
    if (fri_.tells_commanded) m.commanded = arm.told();
    if (fri_.tells_external) m.external_torque = arm.external();
    m.session = session_, m.quality = quality_;
    m.period = fri_.send_period, m.multiplier = fri_.multiplier;
    if (session_ >= Session::commanding_wait) m.interpolated = held_, m.overlay = fri_.overlay;
    return print(m, out);
  }

  [[nodiscard]] bool answered() const override {
    return answered_ || !begun_ || (number_ + 1) % fri_.multiplier != 0 || !ended.empty();
  }
  void emergency_stop(SpringArm& arm) override { emergency_ = true, fall_back(arm, "emergency stop"); }
  void restart() override { number_ = 0; }

 private:
  static constexpr std::size_t window = 100;
  void judge_answer() {
    kept_[judged_++ % window] = answered_;
    if (!answered_) ++late;
  }
  /// Share of the last answers due that did not come in time.
  [[nodiscard]] double missing() const {
    const std::size_t n = std::min(judged_, window);
    const auto kept = std::count(kept_.begin(), kept_.begin() + static_cast<std::ptrdiff_t>(n), true);
    return n == 0 ? 1 : 1 - static_cast<double>(kept) / static_cast<double>(n);
  }
  [[nodiscard]] Quality quality_of(double share) const {
    return share > fri_.fair   ? Quality::poor
           : share > fri_.good ? Quality::fair
           : share > 0         ? Quality::good
                               : Quality::excellent;
  }
  void fall_back(SpringArm& arm, const char* why) {
    end(arm, why);
    session_ = quality_ < Quality::good ? Session::monitoring_wait : Session::monitoring_ready;
  }
  /// The session's next state, and the motion of the cycle.
  void go_on(SpringArm& arm) {
    if (session_ == Session::commanding) {
      if (!answered_) ++since_;  // it holds the last command
      if (answered_) follow(arm);
      return;
    }
    if (answered_ && quality_ >= Quality::good) ++steady_;
    if (session_ == Session::commanding_wait && answered_)
      for (std::size_t i = 0; i < SpringArm::joints; ++i)
        if (std::abs(command_.position[i] - held_[i]) > 1e-6)
          steady_ = 0;  // it has to be where the motion is
    if (steady_ < fri_.before || (session_ == Session::monitoring_ready && !fri_.motion_begins)) return;
    steady_ = 0;
    session_ = session_ == Session::idle               ? Session::monitoring_wait
               : session_ == Session::monitoring_wait  ? Session::monitoring_ready
               : session_ == Session::monitoring_ready ? Session::commanding_wait
                                                       : Session::commanding;
  }
  void follow(SpringArm& arm) {
    const double dt = period() * fri_.multiplier * std::exchange(since_, 1);
    for (std::size_t i = 0; i < SpringArm::joints; ++i)
      if (std::abs(command_.position[i] - arm.told()[i]) > fri_.max_speed * dt)
        return fall_back(arm, "a command too fast");
    const bool torques = fri_.overlay == Overlay::torque;
    if (torques && !command_.torque) return fall_back(arm, "no torque in the command");
    arm.command(command_.position, torques ? *command_.torque : SevenJoints{});
  }

  Config config_;
  FriConfig fri_;
  SevenJoints held_;  ///< where the Java program's own motion holds [rad]
  Command command_;
  std::array<bool, window> kept_{};
  std::size_t judged_ = 0;
  std::uint32_t number_ = 0;
  unsigned steady_ = 0, since_ = 1;  ///< answers of this session state; cycles since the last command
  Session session_ = Session::monitoring_wait;
  Quality quality_ = Quality::poor;
  bool answered_ = false, begun_ = false, emergency_ = false;
};

}  // namespace

std::unique_ptr<SpringFace> fri_face(const Config& config, const FriConfig& fri) {
  return std::make_unique<FriFace>(config, fri);
}
std::unique_ptr<SpringController> fri_controller(const SpringArm::Model& model, const Config& config,
                                                 const FriConfig& fri, const std::string& host,
                                                 std::uint16_t port) {
  auto arm = fri.arm;
  arm.period = 1e-3 * fri.send_period * fri.multiplier;
  return std::make_unique<SpringController>(fri_face(config, fri), adapters::UdpSocket::to(host, port),
                                            config, SpringArm(model, config, arm));
}

}  // namespace simulated_arm

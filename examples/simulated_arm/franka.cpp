#include "examples/simulated_arm/franka.hpp"

namespace simulated_arm {
namespace {

using namespace adapters::franka;

constexpr SevenJoints lowest{-2.7437, -1.7837, -2.9007, -3.0421, -2.8065, 0.5445, -3.0159},
    highest{2.7437, 1.7837, 2.9007, -0.1518, 2.8065, 4.5169, 3.0159},  // [rad]
    max_torque{87, 87, 87, 87, 12, 12, 12},                            // [N m]
    max_velocity{2.62, 2.62, 2.62, 2.62, 5.26, 4.18, 5.26};  // far from the ends of the range [rad/s]
constexpr double max_acceleration = 10, max_jerk = 5000;     // [rad/s^2], [rad/s^3]
constexpr double max_torque_rate = 1000;                     // [N m/s]

/// The most with which joint `i` may go on when `left` is left of its range: sqrt(factor * left) - offset.
double velocity_towards_end(std::size_t i, double left) {
  constexpr SevenJoints factor{12, 5.17, 7, 8, 34, 11, 34}, offset{0.3, 0.2, 0.2, 0.3, 0.35, 0.35, 0.35};
  constexpr double beyond = 0.006;  // the end of the formula behind that of the range, about [rad]
  return std::clamp(std::sqrt(std::max(0.0, factor[i] * (left + beyond))) - offset[i], 0.0, max_velocity[i]);
}

class FrankaFace final : public SpringFace {
 public:
  FrankaFace(const Config& config, const FrankaConfig& franka, std::uint16_t port)
      : config_(config), franka_(franka), acceptor_(adapters::listen(io_, "127.0.0.1", port)) {
    acceptor_.non_blocking(true);
    stiffness_.fill(franka.arm.stiffness);
    max_contact_torque_ = max_torque;
    state_.told = franka.arm.home;
    state_.mode = Mode::idle;
  }
  [[nodiscard]] double period() const override { return 1e-3; }
  [[nodiscard]] std::uint16_t port(const adapters::UdpSocket&) const override {
    return acceptor_.local_endpoint().port();
  }

  void attend(SpringArm& arm, adapters::UdpSocket& socket) override {
    if (config_.faults.mute) return;
    if (!client_.is_open()) {
      if (!client_.accept_waiting(acceptor_)) return;
      inbox_ = {};
      greeted_ = false;
    }
    std::size_t count = 0;
    const auto got = client_.read_some(inbox_.room(), count, adapters::Timeout(0));
    inbox_.took(count);
    Message m;
    while (client_.is_open() && inbox_.next(m)) handle(m, arm, socket);
    if (got == adapters::Read::closed || inbox_.broken()) hang_up(arm);
  }

  std::size_t hear(std::span<const std::uint8_t> bytes, SpringArm&, std::span<std::uint8_t>) override {
    Command c;
    if (!greeted_ || !moves_ || answered_ || !parse(bytes, c) || c.number != state_.number) return 0;
    command_ = c;
    answered_ = begun_ = true;
    ++answers;
    return 0;
  }

  void cycle(SpringArm& arm) override {
    ++state_.number;
    if (moves_ && begun_) {
      judge_answer();
      if (answered_)
        follow(arm);
      else if (lost_ >= franka_.lost_in_a_row)
        reflex(arm, Error::communication);
      else
        go_on(arm);
    }
    if (moves_) judge_body(arm);
    if (moves_ && answered_ && command_.finished) finish(arm);
    answered_ = false;
  }

  std::size_t state(const SpringArm& arm, std::span<std::uint8_t> out) override {
    if (!greeted_) return 0;
    State& s = state_;
    s.q = arm.q(), s.dq = arm.dq();
    s.motor_torque = arm.motor_torque();
    s.external = arm.external();
    s.wrench = {arm.force().x, arm.force().y, arm.force().z, 0, 0, 0};
    const auto X = arm.flange();
    const auto &x = X.axis_x(), &y = X.axis_y(), &z = X.axis_z(), &p = X.origin();
    s.pose = {x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, z.x, z.y, z.z, 0, p.x, p.y, p.z, 1};
    return print(s, out);
  }

  /// Before the first command of a motion nobody is waited for.
  [[nodiscard]] bool answered() const override { return answered_ || !moves_ || !begun_; }
  void emergency_stop(SpringArm& arm) override {
    if (state_.mode == Mode::user_stopped) return;
    end_motion(arm, moved::by_emergency);
    state_.mode = Mode::user_stopped;
    end(arm, "user stop");
  }
  void restart() override { state_.number = 0; }

 private:
  static constexpr std::size_t window = 100;
  static constexpr double dt = 1e-3;

  void say(const Message& request, std::span<const std::uint8_t> payload) {
    std::array<std::uint8_t, 64> bytes;
    const auto size = print(Message{request.function, request.number, payload}, bytes);
    if (!client_.write({bytes.data(), size}, adapters::Timeout(20))) client_.close();
  }
  void say(const Message& request, std::uint8_t status) { say(request, {&status, 1}); }
  void hang_up(SpringArm& arm) {
    client_.close();
    greeted_ = false;
    if (moves_) reflex(arm, Error::communication);
  }

  void handle(const Message& m, SpringArm& arm, adapters::UdpSocket& socket) {
    if (!greeted_ && m.function != Function::connect) return hang_up(arm);
    switch (m.function) {
      case Function::connect:
        return connect(m, arm, socket);
      case Function::move:
        return move(m, arm);
      case Function::stop_move:
        if (!moves_) return say(m, not_possible);
        end_motion(arm, moved::preempted);
        return say(m, success);
      case Function::recover:
        if (state_.mode == Mode::user_stopped) return say(m, not_possible);
        state_.mode = Mode::idle;
        state_.errors.reset();
        ended.clear();
        return say(m, success);
      case Function::load_model:  // it has none to give
        return say(m, std::uint8_t{1});
      default:
        return say(m, set(m, arm));
    }
  }

  void connect(const Message& m, SpringArm& arm, adapters::UdpSocket& socket) {
    Connect c;
    if (greeted_ || !parse(m.payload, c)) return hang_up(arm);
    const bool same = c.version == franka_.version;
    const std::array<std::uint8_t, 3> answer{same ? success : other_version,
                                             static_cast<std::uint8_t>(franka_.version),
                                             static_cast<std::uint8_t>(franka_.version >> 8)};
    say(m, answer);
    if (!same || c.udp_port == 0) return hang_up(arm);
    try {
      socket = adapters::UdpSocket::to(client_.remote_address().to_string(), c.udp_port);
    } catch (const std::exception&) {
      return hang_up(arm);
    }
    greeted_ = true;
  }

  void move(const Message& m, SpringArm& arm) {
    Move asked;
    const bool known = parse(m.payload, asked) && asked.control != Control::cartesian_impedance &&
                       (asked.generator == Generator::position || asked.generator == Generator::velocity);
    if (!known) return say(m, moved::invalid);
    if (state_.mode == Mode::user_stopped) return say(m, moved::by_emergency);
    if (state_.mode != Mode::idle || !franka_.takes_motion) return say(m, moved::not_possible);
    motion_ = {Function::move, m.number, {}};
    moves_ = true;
    begun_ = answered_ = false;
    lost_ = 0;
    judged_ = 0;
    state_.mode = Mode::move;
    state_.control = asked.control, state_.generator = asked.generator;
    state_.reasons.reset();
    state_.success = 0;
    state_.told_torque = {};
    if (asked.control == Control::torque) arm.hold_by({});
    say(m, moved::started);
  }

  std::uint8_t set(const Message& m, SpringArm& arm) {
    const auto numbers = [&](auto& x) { return parse(m.payload, std::span<double>(x)); };
    SevenJoints k;
    std::array<double, 6> six;
    std::array<double, 16> frame;
    std::array<double, 13> load;
    std::array<double, 4 * 7 + 4 * 6> thresholds;
    const auto within = [](const auto& x, double min, double max) {
      return std::all_of(x.begin(), x.end(), [=](double v) { return v >= min && v <= max; });
    };
    switch (m.function) {
      case Function::set_collision_behavior:
        if (!numbers(thresholds) || !within(thresholds, 0, 1e6)) return invalid;
        // The upper ones of a motion without acceleration: lower ones only report.
        std::copy_n(thresholds.begin() + 21, 7, max_contact_torque_.begin());
        max_contact_force_ = thresholds[28 + 18];
        return success;
      case Function::set_joint_impedance:
        if (moves_) return not_possible;
        if (!numbers(k) || !within(k, 0, 14250)) return invalid;
        stiffness_ = k;
        hold(arm);
        return success;
      // The rest is taken and changes nothing here.
      case Function::set_cartesian_impedance:
        return moves_ ? not_possible : numbers(six) ? success : invalid;
      case Function::set_guiding_mode:
        return m.payload.size() == 7 ? success : invalid;
      case Function::set_ee_to_k:
      case Function::set_ne_to_ee:
        return moves_ ? not_possible : numbers(frame) ? success : invalid;
      case Function::set_load:
        return moves_ ? not_possible : numbers(load) ? success : invalid;
      default:
        return invalid;
    }
  }

  void judge_answer() {
    kept_[judged_++ % window] = answered_;
    if (!answered_) ++late;
    lost_ = answered_ ? 0 : lost_ + 1;
    const auto n = static_cast<std::ptrdiff_t>(std::min(judged_, window));
    state_.success = static_cast<double>(std::count(kept_.begin(), kept_.begin() + n, true)) / window;
  }

  /// A cycle of its own, as if the command had gone on: at the same acceleration, or at the same torque.
  void go_on(SpringArm& arm) {
    State& s = state_;
    if (s.control == Control::torque) return arm.command(arm.told(), s.told_torque);
    for (std::size_t i = 0; i < SpringArm::joints; ++i) {
      s.told_dq[i] += dt * s.told_ddq[i];
      s.told[i] = std::clamp(s.told[i] + dt * s.told_dq[i], lowest[i], highest[i]);
    }
    arm.command(s.told);
  }

  void follow(SpringArm& arm) {
    State& s = state_;
    if (s.control == Control::torque) {
      for (std::size_t i = 0; i < SpringArm::joints; ++i) {
        const double torque = command_.torque[i];
        if (std::abs(torque - s.told_torque[i]) > max_torque_rate * dt * (1 + 1e-6))
          return reflex(arm, Error::torque_step);
        if (std::abs(torque) > max_torque[i]) return reflex(arm, Error::torque_range);
      }
      s.told_torque = command_.torque;
      return arm.command(arm.told(), s.told_torque);
    }
    const bool by_position = s.generator == Generator::position;
    State next = s;
    for (std::size_t i = 0; i < SpringArm::joints; ++i) {
      next.told_dq[i] = by_position ? (command_.q[i] - s.told[i]) / dt : command_.dq[i];
      next.told[i] = by_position ? command_.q[i] : s.told[i] + dt * command_.dq[i];
      next.told_ddq[i] = (next.told_dq[i] - s.told_dq[i]) / dt;
      const double v = next.told_dq[i], left = v > 0 ? highest[i] - s.told[i] : s.told[i] - lowest[i];
      if (by_position && judged_ == 1 && std::abs(next.told[i] - s.told[i]) > franka_.start_tolerance)
        return reflex(arm, Error::start_pose);
      if (next.told[i] < lowest[i] || next.told[i] > highest[i]) return reflex(arm, Error::position_range);
      if (std::abs(v) > velocity_towards_end(i, left) + 1e-3) return reflex(arm, Error::velocity_limits);
      if (std::abs(next.told_ddq[i]) > max_acceleration + 1e-3) return reflex(arm, Error::velocity_step);
      if (std::abs(next.told_ddq[i] - s.told_ddq[i]) > dt * (max_jerk + 1))
        return reflex(arm, Error::acceleration_step);
    }
    s = next;
    arm.command(s.told);
  }

  /// What the body does, whatever it was told.
  void judge_body(SpringArm& arm) {
    for (std::size_t i = 0; i < SpringArm::joints; ++i) {
      if (std::abs(arm.external()[i]) > max_contact_torque_[i]) return reflex(arm, Error::joint_reflex);
      if (arm.q()[i] < lowest[i] || arm.q()[i] > highest[i]) return reflex(arm, Error::position_limits);
      if (std::abs(arm.dq()[i]) > max_velocity[i]) return reflex(arm, Error::velocity);
    }
    const auto& F = arm.force();
    if (std::max({std::abs(F.x), std::abs(F.y), std::abs(F.z)}) > max_contact_force_)
      reflex(arm, Error::cartesian_reflex);
  }

  /// A motion that ends while it is told to be fast is one that steps.
  void finish(SpringArm& arm) {
    if (state_.control != Control::torque)
      for (const double v : state_.told_dq)
        if (std::abs(v) > max_acceleration * dt) return reflex(arm, Error::velocity_step);
    end_motion(arm, success);
  }
  void reflex(SpringArm& arm, Error error) {
    const auto k = static_cast<std::size_t>(error);
    state_.errors.set(k), state_.reasons.set(k);
    end_motion(arm, moved::by_reflex);
    state_.mode = Mode::reflex;
    end(arm, name(k));
  }
  void end_motion(SpringArm& arm, std::uint8_t status) {
    if (!moves_) return;
    const bool by_torque = state_.control == Control::torque;
    moves_ = begun_ = false;
    state_.mode = Mode::idle;
    state_.generator = Generator::idle, state_.control = Control::other;
    state_.success = 0;
    state_.told_dq = state_.told_ddq = state_.told_torque = {};
    if (by_torque) hold(arm);
    if (client_.is_open()) say(motion_, status);
  }
  /// By the springs that were set, where it is.
  void hold(SpringArm& arm) {
    arm.hold_by(stiffness_);
    state_.told = arm.told();
  }

  Config config_;
  FrankaConfig franka_;
  boost::asio::io_context io_;
  boost::asio::ip::tcp::acceptor acceptor_;
  adapters::Stream client_;
  Inbox inbox_;
  State state_;
  Command command_;
  Message motion_;  ///< the request that began it
  SevenJoints stiffness_, max_contact_torque_;
  double max_contact_force_ = 1e3;
  std::array<bool, window> kept_{};
  std::size_t judged_ = 0;  ///< cycles of this motion
  unsigned lost_ = 0;       ///< of them in a row, the last ones
  bool greeted_ = false, moves_ = false, begun_ = false, answered_ = false;
};

}  // namespace

std::unique_ptr<SpringFace> franka_face(const Config& config, const FrankaConfig& franka,
                                        std::uint16_t port) {
  return std::make_unique<FrankaFace>(config, franka, port);
}
std::unique_ptr<SpringController> franka_controller(const SpringArm::Model& model, const Config& config,
                                                    const FrankaConfig& franka, std::uint16_t port) {
  return std::make_unique<SpringController>(franka_face(config, franka, port),
                                            adapters::UdpSocket::at("127.0.0.1", 0), config,
                                            SpringArm(model, config, franka.arm));
}

}  // namespace simulated_arm

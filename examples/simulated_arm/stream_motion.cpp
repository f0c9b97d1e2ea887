#include "examples/simulated_arm/stream_motion.hpp"

#include <map>
#include <numbers>

namespace simulated_arm {
namespace {

using namespace adapters::stream_motion;
constexpr double degree = std::numbers::pi / 180;

class StreamMotionFace final : public Face {
 public:
  StreamMotionFace(const Config& config, const StreamMotionConfig& stream) : config_(config), s_(stream) {}
  [[nodiscard]] double period() const override { return 1e-3 * s_.period_ms; }

  std::size_t hear(std::span<const std::uint8_t> bytes, Arm& arm, std::span<std::uint8_t> out) override {
    Capability capability;
    if (parse(bytes, capability)) {
      capability = {.id = 1, .sampling = s_.period_ms, .start_move = s_.start_move, .available = s_.version};
      return print(capability, out);
    }
    if (LimitsQuestion q; parse(bytes, q) && q.axis >= 1 && q.axis <= 6 && q.kind < 3) {
      Limits limits{.axis = q.axis, .kind = q.kind, .max_speed = 2000, .interval = 100};
      limits.empty.fill(static_cast<float>(s_.limits[q.kind][q.axis - 1]));
      limits.loaded = limits.empty;
      return print(limits, out);
    }
    if (Command c; parse(bytes, c)) return command(c, arm), 0;
    if (Header h; parse(bytes, h)) {
      if (h.type == type::start && (h.version == s_.version || h.version == 3)) start(h.version);
      if (h.type == type::stop) streaming_ = false;
    }
    return 0;
  }

  void cycle(Arm& arm) override {
    if (!streaming_) return;
    ++sequence_;
    if (emergency_ > 0) ++emergency_;
    received_ = false;
    begun_ = begun_ || queue_.size() > s_.start_move;
    if (!begun_ || !ended.empty() || finished_) return;
    const auto waiting = queue_.find(++executed_);
    if (waiting == queue_.end()) {
      ++late;
      real_ = 0;
      if (++missing_ * period() > s_.coast) return end(arm, "commands came late or not at all");
      SixJoints q = last_[0];
      for (std::size_t i = 0; i < 6; ++i) q[i] += last_[0][i] - last_[1][i];
      return go(arm, q);
    }
    missing_ = 0;
    ++answers;
    const SixJoints q = waiting->second;
    finished_ = finished_ || executed_ == last_number_;
    queue_.erase(queue_.begin(), std::next(waiting));
    if (++real_ >= 4) check(arm, q);
    if (ended.empty()) go(arm, q);
  }

  std::size_t state(const Arm& arm, std::span<std::uint8_t> out) override {
    if (!streaming_) return 0;
    Status s{.sequence = sequence_};
    s.header = {version_ >= 4 ? type::status_4 : type::status_3, version_};
    bool moving = false;
    for (const double v : arm.dq()) moving = moving || std::abs(v) > 1e-3;
    const bool ready = sequence_ > 3 && ended.empty() && !(finished_ && !moving);
    s.status = static_cast<std::uint8_t>((ready ? Status::ready : 0) | (received_ ? Status::received : 0) |
                                         Status::system_ready | (moving ? Status::moving : 0));
    s.robot = static_cast<std::uint8_t>((error_ ? Status::error : 0) |
                                        (emergency_ * period() > 0.5 ? Status::emergency_stop : 0));
    s.milliseconds = static_cast<std::uint32_t>(std::llround(1e3 * arm.time()));
    for (std::size_t i = 0; i < 6; ++i) s.joints[i] = static_cast<float>(arm.q()[i] / degree);
    for (std::size_t i = 0; i < 6; ++i) s.force[i] = static_cast<float>(arm.wrench()[i]);
    s.sensor = config_.sensor ? 2 : 0;
    return print(s, out);
  }

  [[nodiscard]] bool answered() const override {
    return !streaming_ || sequence_ < 4 || finished_ || !ended.empty() || newest_ >= sequence_;
  }
  void emergency_stop(Arm& arm) override {
    if (ended.empty()) emergency_ = 1;  // the error comes first, the bit of the stop half a second later
    error_ = true;
    end(arm, "emergency stop");
  }
  void restart() override { sequence_ = 4; }

 private:
  void start(std::uint32_t version) {
    version_ = version;
    streaming_ = true;
    begun_ = finished_ = false;
    sequence_ = executed_ = newest_ = 0;
    last_number_ = ~0u;
    queue_.clear();
  }
  void command(const Command& c, Arm& arm) {
    if (!streaming_ || c.header.version != version_ || c.moves != 1 || !ended.empty()) return;
    if (c.style != joint_style) return fault(arm, "a pose was sent for joints");
    SixJoints q{};
    for (std::size_t i = 0; i < 6; ++i) {
      if (!(std::abs(c.joints[i]) < 1e4)) return fault(arm, "no number");
      q[i] = degree * c.joints[i];
    }
    received_ = true;
    if (queue_.empty() && !begun_) {
      executed_ = c.sequence - 1;
      last_.fill(arm.told());
      for (std::size_t i = 0; i < 6; ++i)
        if (std::abs(q[i] - arm.q()[i]) > 0.01)
          return fault(arm, "the first command is elsewhere than the arm");
    }
    if (c.sequence <= executed_ || queue_.size() > 20) return;
    newest_ = std::max(newest_, c.sequence);
    if (c.last != 0) last_number_ = c.sequence;
    queue_[c.sequence] = q;
  }
  void fault(Arm& arm, std::string why) {
    error_ = true;
    end(arm, std::move(why));
  }
  /// Differences of the last commands against the tables of limits.
  void check(Arm& arm, const SixJoints& q) {
    const double T = period();
    for (std::size_t i = 0; i < 6; ++i) {
      const double v = q[i] - last_[0][i], v1 = last_[0][i] - last_[1][i], v2 = last_[1][i] - last_[2][i];
      const double of[] = {v / T, (v - v1) / (T * T), (v - 2 * v1 + v2) / (T * T * T)};
      for (std::size_t k = 0; k < 3; ++k)
        if (std::abs(of[k]) > degree * s_.strictness * s_.limits[k][i] * (1 + 1e-3))
          return fault(arm, std::string(k == 0 ? "velocity" : (k == 1 ? "acceleration" : "jerk")) + " of J" +
                                std::to_string(i + 1) + ": " + std::to_string(of[k] / degree));
    }
  }
  void go(Arm& arm, const SixJoints& q) {
    last_ = {q, last_[0], last_[1]};
    arm.command(q);
  }

  Config config_;
  StreamMotionConfig s_;
  std::map<std::uint32_t, SixJoints> queue_;
  std::array<SixJoints, 3> last_{};  ///< executed, the newest first
  std::uint32_t version_ = 3, sequence_ = 0, executed_ = 0, newest_ = 0, last_number_ = ~0u;
  int missing_ = 0, real_ = 0, emergency_ = 0;
  bool streaming_ = false, begun_ = false, finished_ = false, received_ = false, error_ = false;
};

}  // namespace

std::unique_ptr<Face> stream_motion_face(const Config& config, const StreamMotionConfig& stream) {
  return std::make_unique<StreamMotionFace>(config, stream);
}
std::unique_ptr<Controller> stream_motion_controller(const Config& config, const StreamMotionConfig& stream,
                                                     const std::string& address, std::uint16_t port) {
  return std::make_unique<Controller>(stream_motion_face(config, stream),
                                      adapters::UdpSocket::at(address, port), config);
}

}  // namespace simulated_arm

#include "examples/simulated_arm/controller.hpp"

#include "examples/simulated_arm/spring_arm.hpp"
#include "skinctl/hardware/scheduling.hpp"

namespace simulated_arm {

template <class A>
ControllerOf<A>::ControllerOf(std::unique_ptr<FaceOf<A>> face, adapters::UdpSocket socket,
                              const Config& config, A arm)
    : face_(std::move(face)),
      socket_(std::move(socket)),
      config_(config),
      arm_(std::move(arm)),
      port_(face_->port(socket_)),
      thread_([this] { run(); }) {}

template <class A>
void ControllerOf<A>::stop() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

template <class A>
SnapshotOf<A::joints> ControllerOf<A>::snapshot() const {
  const std::lock_guard lock(mutex_);
  return snapshot_;
}

template <class A>
void ControllerOf<A>::hear(const Bytes& bytes) {
  Bytes out(longest);
  out.resize(face_->hear(bytes, arm_, out));
  if (!out.empty() && !config_.faults.mute) static_cast<void>(socket_.send(out));
}

template <class A>
void ControllerOf<A>::listen(Clock::time_point until) {
  Bytes bytes(longest);
  const Faults& f = config_.faults;
  const bool waits = config_.speed == 0 && !face_->answered();
  const auto patience = waits ? Clock::now() + std::chrono::seconds(20) : until;
  while (!stop_ && !(waits && face_->answered())) {
    std::size_t size = 0;
    const auto slice = std::min(patience, Clock::now() + std::chrono::milliseconds(20));
    const auto got = socket_.receive(bytes, size, slice);
    if (got == adapters::Read::some && size > 0 && !happens(f.lose_answers)) {
      const Bytes one(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
      if (f.late_answers > 0 && arm_.time() >= f.from)
        waiting_.push_back({arm_.time() + f.late_answers, one});
      else
        hear(one);
    }
    face_->attend(arm_, socket_);
    if (Clock::now() >= patience) break;
  }
  for (; !waiting_.empty() && waiting_.front().at <= arm_.time(); waiting_.pop_front())
    hear(waiting_.front().bytes);
}

template <class A>
void ControllerOf<A>::tell(Bytes bytes) {
  const Faults& f = config_.faults;
  if (happens(f.garbled))
    for (auto& b : bytes) b = static_cast<std::uint8_t>(random_());
  if (happens(f.cut)) bytes.resize(bytes.size() / 2);
  if (f.mute || happens(f.lose)) return;
  if (held_.empty() && happens(f.swap)) {
    held_ = std::move(bytes);
    return;
  }
  static_cast<void>(socket_.send(bytes));
  if (happens(f.twice)) static_cast<void>(socket_.send(bytes));
  if (!held_.empty()) static_cast<void>(socket_.send(std::exchange(held_, {})));
}

template <class A>
void ControllerOf<A>::run() {
  const auto period = std::chrono::nanoseconds(std::llround(1e9 * face_->period()));
  const Faults& f = config_.faults;
  if (config_.speed > 0) static_cast<void>(skinctl::request_real_time());
  auto next = Clock::now();
  for (std::uint64_t k = 1; !stop_; ++k) {
    // What a busy machine delays is not caught up in bursts.
    next = config_.speed == 0 ? Clock::now() + period : std::max(next + period, Clock::now());
    listen(next);
    arm_.advance(static_cast<double>(k) * face_->period());
    const double t = arm_.time();
    if (f.halted_at >= 0 && t >= f.halted_at) face_->emergency_stop(arm_);
    if (f.restart_at >= 0 && t >= f.restart_at && !std::exchange(restarted_, true)) face_->restart();
    face_->cycle(arm_);
    if (config_.watched) config_.watched(t, arm_.q());
    const bool silent = f.silent_at >= 0 && t >= f.silent_at;
    if (silent) arm_.halt();
    Bytes bytes(longest);
    bytes.resize(silent ? 0 : face_->state(arm_, bytes));
    if (!bytes.empty()) ++states_, tell(std::move(bytes));
    for (const double v : arm_.dq())
      if (std::abs(v) > 1e-3) moved_at_ = t;
    const std::lock_guard lock(mutex_);
    snapshot_ = {
        {t, face_->ended, face_->late, face_->answers, states_, moved_at_}, arm_.q(), arm_.dq(), arm_.told()};
  }
}

template class ControllerOf<Arm>;
template class ControllerOf<SpringArm>;

}  // namespace simulated_arm

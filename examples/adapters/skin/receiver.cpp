#include "examples/adapters/skin/receiver.hpp"

#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <ctime>

#include "examples/adapters/socket.hpp"
#include "skinctl/core/contract.hpp"

namespace adapters::skin {

using skinctl::Nanoseconds;
using namespace std::chrono_literals;
namespace ip = boost::asio::ip;

namespace {

/// Questions in one poll to those who have not heard the newest one: each costs a system call.
constexpr std::size_t most_replies = 16;

}  // namespace

/// What one system call receives.
struct ReceiverCore::Batch {
  static constexpr std::size_t size = 64;

  std::array<std::array<std::uint8_t, largest + 1>, size> bytes;  // one more, to see that one is too long
  std::array<sockaddr_storage, size> from{};
  std::array<iovec, size> part{};
  std::array<mmsghdr, size> message{};
  struct alignas(cmsghdr) Control {
    std::array<std::uint8_t, CMSG_SPACE(sizeof(timespec))> bytes;
  };
  std::array<Control, size> control;  // when the system received it

  Batch() {
    for (std::size_t i = 0; i < size; ++i) {
      part[i] = {bytes[i].data(), bytes[i].size()};
      message[i].msg_hdr.msg_name = &from[i];
      message[i].msg_hdr.msg_iov = &part[i];
      message[i].msg_hdr.msg_iovlen = 1;
      message[i].msg_hdr.msg_control = control[i].bytes.data();
    }
  }
  /// How many datagrams arrived, at most `most`; 0 where there are none.
  std::size_t receive(int handle, std::size_t most) noexcept {
    for (std::size_t i = 0; i < most; ++i) {
      message[i].msg_hdr.msg_namelen = sizeof(sockaddr_storage);
      message[i].msg_hdr.msg_controllen = sizeof(Control);
    }
    const int n = ::recvmmsg(handle, message.data(), static_cast<unsigned>(most), MSG_DONTWAIT, nullptr);
    return n > 0 ? static_cast<std::size_t>(n) : 0;
  }
  /// How long datagram `i` had waited at `now` of the system's clock, at most `longest`; 0 where the system
  /// does not tell.
  Nanoseconds waited(std::size_t i, const timespec& now, Nanoseconds longest) noexcept {
    const cmsghdr* const told = CMSG_FIRSTHDR(&message[i].msg_hdr);
    if (told == nullptr || told->cmsg_level != SOL_SOCKET || told->cmsg_type != SCM_TIMESTAMPNS) return {};
    timespec at{};
    std::memcpy(&at, CMSG_DATA(told), sizeof at);
    const Nanoseconds since =
        std::chrono::seconds(now.tv_sec - at.tv_sec) + Nanoseconds(now.tv_nsec - at.tv_nsec);
    return std::clamp(since, Nanoseconds(0), longest);
  }
};

ReceiverCore::ReceiverCore(const ReceiverConfig& config, const Kind& kind)
    : config_(config), socket_(io_), kind_(kind), clock_(config.clock) {
  skinctl::require(config.max_samples >= kind.most && config.max_samples <= (1u << 24),
                   "skin receiver: max_samples", double(config.max_samples),
                   (std::to_string(kind.most) + " to 2^24").c_str());
  skinctl::require(config.max_datagrams >= 1 && config.max_datagrams <= (1u << 20),
                   "skin receiver: max_datagrams", double(config.max_datagrams), "1 to 2^20");
  skinctl::require(config.buffer <= (1u << 30), "skin receiver: buffer", double(config.buffer), "up to 2^30");
  skinctl::require(config.noise >= 0 && config.noise <= 1000, "skin receiver: noise", config.noise,
                   "0 to 1000 steps");
  skinctl::require(config.max_cells <= (1u << 20), "skin receiver: max_cells", double(config.max_cells),
                   "up to 2^20");
  try {
    const ip::udp::endpoint endpoint(ip::make_address(config.address), config.port);
    if (!config.sender.empty()) {
      const auto only = ip::make_address(config.sender);
      if (only.is_v4() != endpoint.address().is_v4())
        skinctl::refuse("skinctl: skin receiver: sender = " + config.sender +
                        ", allowed: an address of the same family as " + config.address);
      only_size_ = only.is_v4() ? 4 : 16;
      if (only.is_v4())
        std::memcpy(only_.data(), only.to_v4().to_bytes().data(), only_size_);
      else
        std::memcpy(only_.data(), only.to_v6().to_bytes().data(), only_size_);
    }
    socket_.open(endpoint.protocol());
    const int handle = socket_.native_handle();
    const int asked = static_cast<int>(config.buffer);
    // Beyond rmem_max only an administrator gets it.
    if (::setsockopt(handle, SOL_SOCKET, SO_RCVBUFFORCE, &asked, sizeof asked) != 0)
      static_cast<void>(::setsockopt(handle, SOL_SOCKET, SO_RCVBUF, &asked, sizeof asked));
    int given = 0;
    socklen_t size = sizeof given;
    if (::getsockopt(handle, SOL_SOCKET, SO_RCVBUF, &given, &size) == 0)
      buffer_ = static_cast<std::size_t>(given) / 2;  // Linux counts its own part as well
    if (config.real_time) {
      const int on = 1;
      static_cast<void>(::setsockopt(handle, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on));
    }
    socket_.bind(endpoint);
    socket_.non_blocking(true);
  } catch (const boost::system::system_error& e) {
    throw ConnectionError("cannot receive skin at " + config.address + ":" + std::to_string(config.port) +
                          ": " + e.what());
  }
  batch_ = std::make_unique<Batch>();
  if (kind.sensors > 0) frozen_after_ = skinctl::Stillness::frozen_after(config.noise, kind.sensors);
  if (frozen_after_ < 65535) watched_.reserve(config.max_cells);
}
ReceiverCore::~ReceiverCore() = default;

void ReceiverCore::receive(Nanoseconds now) noexcept {
  taken_ = 0;
  replies_ = most_replies;
  // The sender's clock against this computer's, since both are steady, where the robot's is known as well as
  // its states come.
  timespec system_now{};
  ::clock_gettime(CLOCK_REALTIME, &system_now);
  const Nanoseconds here = config_.real_time ? std::chrono::steady_clock::now().time_since_epoch() : now;
  robot_ahead_ = now - here;
  // What came since the last poll cannot have waited longer, whatever a clock that was set says.
  const Nanoseconds longest =
      std::clamp(polled_ ? here - *polled_ : Nanoseconds(0), Nanoseconds(0), Nanoseconds(1s));
  polled_ = here;
  if (config_.key && questions_.ask(now) && has_sender_) ask(sender_.data(), sender_size_);
  if (!shown() && has_sender_) tell_lights(now);
  // Bounded: a flood cannot keep the loop here.
  std::size_t left = config_.max_datagrams;
  while (left > 0) {
    const std::size_t room = (config_.max_samples - taken_) / kind_.most;
    const std::size_t most = std::min({Batch::size, left, room});
    const std::size_t n = most > 0 ? batch_->receive(socket_.native_handle(), most) : 0;
    for (std::size_t i = 0; i < n; ++i) {
      const mmsghdr& message = batch_->message[i];
      receive(std::span(batch_->bytes[i]).first(std::min<std::size_t>(message.msg_len, largest + 1)),
              message.msg_hdr.msg_name, message.msg_hdr.msg_namelen, now,
              here - batch_->waited(i, system_now, longest));
    }
    left -= n;
    if (n < most || n == 0) break;
  }
}

void ReceiverCore::receive(std::span<const std::uint8_t> bytes, const void* from, std::size_t from_size,
                           Nanoseconds now, Nanoseconds arrived) noexcept {
  Datagram datagram;
  if (!parse(bytes, datagram)) {
    const auto number = parse_shown(bytes, config_.key ? &*config_.key : nullptr);
    if (number && is_sender(from, from_size)) {
      shown_ = *number;
      return;
    }
    ++statistics_.nonsense;
    return;
  }
  if (!admit(datagram, bytes, from, from_size, now)) return;
  has_sender_ = true;
  sender_size_ = std::min(from_size, sender_.size());
  std::memcpy(sender_.data(), from, sender_size_);
  newest_ = datagram.sequence;
  heard_at_ = now;
  ++statistics_.datagrams;
  hear(datagram, arrived);
}

/// Whether the datagram is one of our sender's, and fresh.
bool ReceiverCore::admit(const Datagram& datagram, std::span<const std::uint8_t> bytes, const void* from,
                         std::size_t from_size, Nanoseconds now) noexcept {
  const auto* address = static_cast<const std::uint8_t*>(from);
  const std::size_t at =
      only_size_ == 4 ? offsetof(sockaddr_in, sin_addr) : offsetof(sockaddr_in6, sin6_addr);
  if (only_size_ > 0 &&
      (from_size < at + only_size_ || std::memcmp(address + at, only_.data(), only_size_) != 0)) {
    ++statistics_.strangers;
    return false;
  }
  if (!config_.key && datagram.sealed) {
    ++statistics_.sealed;
    return false;
  }
  if (config_.key && !datagram.sealed) {
    ++statistics_.unsealed;
    return false;
  }
  if (datagram.kind != kind_.fingerprint || datagram.readings != kind_.readings) {
    ++statistics_.other_kind;
    return false;
  }
  return config_.key ? sealed(datagram, bytes, from, from_size, now) : open(datagram, from, from_size, now);
}

/// A newer datagram of the sender whose numbers rise by `step`; counts those in between as lost.
bool ReceiverCore::follows(std::int64_t step) noexcept {
  if (step <= 0) {
    ++statistics_.late;
    return false;
  }
  statistics_.lost += static_cast<std::uint64_t>(step - 1);
  return true;
}

/// Without a key: the first sender is kept to until it is silent.
bool ReceiverCore::open(const Datagram& datagram, const void* from, std::size_t from_size,
                        Nanoseconds now) noexcept {
  if (!has_sender_ || now - heard_at_ > config_.forget) {
    if (has_sender_) ++statistics_.restarts;
    clock_memory_ = {};
    return true;
  }
  if (!is_sender(from, from_size)) {
    ++statistics_.strangers;
    return false;
  }
  return follows(static_cast<std::int32_t>(datagram.sequence - newest_));
}

/// With a key: a right tag, and an answer to a question of ours.
bool ReceiverCore::sealed(const Datagram& datagram, std::span<const std::uint8_t> bytes, const void* from,
                          std::size_t from_size, Nanoseconds now) noexcept {
  const bool old = datagram.version == 2;
  if (old && (!config_.version_2 || answers_)) {
    ++statistics_.version_2;
    return false;
  }
  if (!config_.key->made(old ? Sealed::version_2 : Sealed::samples, bytes)) {
    ++statistics_.forged;
    return false;
  }
  if (old) return session(datagram);
  const std::int64_t step = std::int64_t(datagram.sequence) - std::int64_t(newest_);
  switch (questions_.judge(datagram.question, datagram.sequence, now)) {
    case Questions::Answer::unasked:
      ++(datagram.question == Question{} ? statistics_.deaf : statistics_.unasked);
      if (replies_ > 0) --replies_, ask(from, from_size);
      return false;
    case Questions::Answer::repeated:
      ++statistics_.late;
      return false;
    case Questions::Answer::restarted:
      ++statistics_.restarts;
      break;
    case Questions::Answer::fresh:
      if (answers_) static_cast<void>(follows(step));
  }
  answers_ = true;
  return true;
}

/// Version 2: sessions rise, and the numbers within each.
bool ReceiverCore::session(const Datagram& datagram) noexcept {
  std::uint64_t session = 0;
  for (std::size_t k = question_size; k > 0; --k) session = session << 8 | datagram.question[k - 1];
  if (session > session_) {
    session_ = session;
    clock_memory_ = {};
    return true;
  }
  if (session < session_) {
    ++statistics_.late;
    return false;
  }
  return follows(std::int64_t(datagram.sequence) - std::int64_t(newest_));
}

/// Sends the newest question; a lost one is asked again.
void ReceiverCore::ask(const void* to, std::size_t to_size) noexcept {
  const auto bytes = question_datagram(questions_.newest(), *config_.key);
  static_cast<void>(::sendto(socket_.native_handle(), bytes.data(), bytes.size(), MSG_DONTWAIT,
                             static_cast<const sockaddr*>(to), static_cast<socklen_t>(to_size)));
}

bool ReceiverCore::is_sender(const void* from, std::size_t from_size) const noexcept {
  return has_sender_ && from_size == sender_size_ && std::memcmp(from, sender_.data(), sender_size_) == 0;
}

void ReceiverCore::show(std::span<const std::uint32_t> lit) {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  // Above those of an earlier run of this program, and of this one.
  const auto number = static_cast<std::uint64_t>(std::chrono::nanoseconds(now).count());
  picture_ = Picture::of(lit, std::max(number, picture_.number + 1));
  told_lights_.reset();
}

/// Sends the picture that is wanted; a lost one, or one whose answer is lost, again.
void ReceiverCore::tell_lights(Nanoseconds now) noexcept {
  if (told_lights_ && now >= *told_lights_ && now - *told_lights_ < Questions::every) return;
  told_lights_ = now;
  std::array<std::uint8_t, largest> bytes;
  std::size_t size = write_picture(bytes, picture_, config_.key.has_value());
  if (config_.key) size = config_.key->seal(Sealed::lights, bytes, size);
  const void* const to = sender_.data();
  static_cast<void>(::sendto(socket_.native_handle(), bytes.data(), size, MSG_DONTWAIT,
                             static_cast<const sockaddr*>(to), static_cast<socklen_t>(sender_size_)));
}

void ReceiverCore::hear(const Datagram& datagram, Nanoseconds arrived) noexcept {
  const auto heard = clock_.hear(clock_memory_, datagram.sent, arrived);
  if (heard == skinctl::ClockOffset::Heard::refused) {
    ++statistics_.nonsense;
    return;
  }
  if (heard == skinctl::ClockOffset::Heard::leapt) ++statistics_.leaps;
  if (skinctl::ClockOffset::ready(clock_memory_))
    take(datagram);
  else
    statistics_.untimed += datagram.count();
}

bool ReceiverCore::counts(bool plausible, std::uint32_t cell, std::uint16_t measured, std::uint16_t unrest,
                          bool at_zero) noexcept {
  if (!plausible || measured == 0) {
    ++(plausible ? statistics_.repeated : statistics_.bad_samples);
    return false;
  }
  if (frozen_after_ < 65535) watch(cell, measured, unrest, at_zero);
  ++statistics_.samples, ++taken_;
  return true;
}

/// Counts the measurements for which a cell has stood still. A cell beyond `max_cells` is not watched, and
/// one that rests below its range is not dead.
void ReceiverCore::watch(std::uint32_t cell, std::uint16_t measured, std::uint16_t unrest,
                         bool at_zero) noexcept {
  auto at = std::lower_bound(watched_.begin(), watched_.end(), cell,
                             [](const Watched& w, std::uint32_t id) { return w.cell < id; });
  if (at == watched_.end() || at->cell != cell) {
    if (watched_.size() == watched_.capacity()) return;
    at = watched_.insert(at, {.cell = cell, .still = {}});
  }
  const bool before = at->still.measurements >= frozen_after_;
  struct {
    std::uint16_t measured, unrest;
  } const said{measured, unrest};
  at->still.take(said);
  if (at_zero) at->still = {};
  const bool after = at->still.measurements >= frozen_after_;
  if (after != before) after ? ++statistics_.frozen : --statistics_.frozen;
}

std::string ReceiverCore::frozen() const {
  constexpr std::size_t most = 8;  // ids that one reads
  std::string out;
  std::size_t count = 0;
  for (const Watched& w : watched_) {
    if (w.still.measurements < frozen_after_ || ++count > most) continue;
    out += (count == 1 ? "" : ", ") + std::to_string(w.cell);
  }
  if (count == 0) return out;
  return std::to_string(count) + (count == 1 ? " cell stands" : " cells stand") +
         " still, without the noise of a sensor: frozen or dead (" + out + (count > most ? ", ...)" : ")");
}

std::string ReceiverCore::leaps() const {
  const auto counted = [](std::uint64_t n, const char* one, const char* more) {
    return n == 0 ? std::string() : std::to_string(n) + (n == 1 ? one : more);
  };
  const auto& s = statistics_;
  const std::string leaps = counted(s.leaps, " leap of the sender's clock", " leaps of the sender's clock"),
                    anew =
                        counted(s.restarts, " new beginning of the sender", " new beginnings of the sender");
  if (leaps.empty() && anew.empty()) return {};
  const auto gather = std::chrono::duration_cast<std::chrono::milliseconds>(config_.clock.gather);
  return leaps + (leaps.empty() || anew.empty() ? "" : ", ") + anew + ": no reading counts for " +
         std::to_string(gather.count()) + (s.leaps + s.restarts == 1 ? " ms after it" : " ms after each");
}

std::string refusals(const Statistics& s) {
  std::string out;
  const auto add = [&out](std::uint64_t count, const char* cause) {
    if (count > 0) out += (out.empty() ? "" : "; ") + std::to_string(count) + " " + cause;
  };
  add(s.nonsense, "no skin datagrams");
  add(s.other_kind, "of another kind of cells");
  add(s.strangers, "from another address");
  add(s.unsealed, "without a seal, though a key is given here");
  add(s.sealed, "sealed, though no key is given here");
  add(s.version_2, "of version 2, whose recordings nobody could tell from the skin");
  add(s.forged, "with a wrong tag: another key, or forged");
  add(s.unasked,
      "with no answer to a question of the last 100 ms: a recording, or a sender far away or of another "
      "receiver");
  add(s.deaf,
      "of a sender that had heard no question yet: if it goes on, UDP does not pass from this program to it");
  add(s.late, "repeated or overtaken");
  add(s.repeated, "samples of old readings that somebody repeats");
  return out;
}

}  // namespace adapters::skin

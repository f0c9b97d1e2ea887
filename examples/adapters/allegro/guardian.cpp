#include "examples/adapters/allegro/guardian.hpp"

#include <fcntl.h>
#include <linux/can.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace adapters::allegro {
namespace {

std::array<Frame, 6> farewell(unsigned hand) {
  return {torque(0, {}, hand), torque(1, {}, hand), torque(2, {}, hand),
          torque(3, {}, hand), servo(false, hand),  period(0, 0, 0, hand)};
}

/// In the second process: only calls that are safe after a fork among threads.
[[noreturn]] void watch(int alive, int link, const Guardian::Words& words) noexcept {
  for (const int ignored : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) ::signal(ignored, SIG_IGN);
  char said = 0;
  ssize_t n = 0;
  do n = ::read(alive, &said, 1);
  while (n < 0 && errno == EINTR);
  for (std::size_t k = 0; n <= 0 && k < words.size(); ++k) {
    for (int tries = 0; tries < 100; ++tries) {  // a full queue empties itself, or the bus is gone
      if (::write(link, words[k].data(), words[k].size()) >= 0) break;
      ::usleep(1000);
    }
  }
  ::_exit(0);
}

}  // namespace

Guardian::Guardian(int link, Words words) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    throw ConnectionError(std::string("no guardian: ") + std::strerror(errno));
  Descriptor reads(ends[0]);
  alive_ = Descriptor(ends[1]);
  child_ = ::fork();
  if (child_ < 0) throw ConnectionError(std::string("no guardian: ") + std::strerror(errno));
  if (child_ == 0) {
    ::close(ends[1]);  // or it would wait for itself
    watch(ends[0], link, words);
  }
}

Guardian::~Guardian() {
  const char bye = 1;
  static_cast<void>(::write(alive_.get(), &bye, 1) == 1);
  alive_.close();
  while (::waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

Guardian::Words last_words(const FrameSocket&, unsigned hand) {
  Guardian::Words words;
  for (const Frame& f : farewell(hand)) {
    can_frame raw{};
    raw.can_id = f.id;
    raw.can_dlc = f.size;
    std::memcpy(raw.data, f.data.data(), f.size);
    words.emplace_back(sizeof raw);
    std::memcpy(words.back().data(), &raw, sizeof raw);
  }
  return words;
}

Guardian::Words last_words(const SlcanLink&, unsigned hand) {
  Guardian::Words words;
  std::array<char, 32> text{};
  for (const Frame& f : farewell(hand)) {
    const std::size_t n = SlcanCodec::write(f, text);
    words.emplace_back(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(n));
  }
  // A line that the dead program began is ended first.
  words.front().insert(words.front().begin(), '\r');
  return words;
}

Guardian::Words last_words_of_udp() {
  const auto none = torques({}, 0, 0);
  return Guardian::Words(3, {none.begin(), none.end()});
}

}  // namespace adapters::allegro
